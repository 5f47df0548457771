# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Completes subcommands and options from the program's own help, and file names.

_trunnion_complete() {
  local program=$1 word=$2 subcommand="" words
  if [ "$COMP_CWORD" -gt 1 ] && [[ ${COMP_WORDS[1]} != -* ]]; then subcommand=${COMP_WORDS[1]}; fi
  local help
  help=$("$program" ${subcommand:+"$subcommand"} --help 2> /dev/null) || help=$("$program" --help 2> /dev/null)
  if [[ $word == -* ]]; then
    words=$(grep -oE -- '--[a-z][a-z0-9-]*' <<< "$help" | sort -u)
  elif [ "$COMP_CWORD" -eq 1 ]; then
    words=$(sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z_]*\) .*/\1/p' <<< "$help")
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -o default -F _trunnion_complete imu_calibrate imu_correct imu_live imu_navigate imu_replay gnss_attitude
