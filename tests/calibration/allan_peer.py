# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause
"""allan_peer.py PROGRAM: our Allan deviation against that of the package allantools, on the same ten million samples."""

import subprocess
import sys
import tempfile
import time

try:
    import allantools
    import numpy
except ImportError:
    print("skipped: the package allantools is not there")
    sys.exit(77)

RATE = 100.0
random = numpy.random.default_rng(1)
readings = random.standard_normal(10_000_000) + 1e-3 * numpy.cumsum(random.standard_normal(10_000_000))
with tempfile.NamedTemporaryFile(suffix=".bin") as file:
    readings.tofile(file.name)
    lines = subprocess.run([sys.argv[1], file.name, repr(1.0 / RATE)], check=True, capture_output=True, text=True).stdout.split("\n")
ours = [tuple(map(float, line.split())) for line in lines if line and not line.startswith("seconds")]
seconds = float([line for line in lines if line.startswith("seconds")][0].split()[1])

start = time.perf_counter()
taus, deviations, _, _ = allantools.oadev(readings, rate=RATE, data_type="freq", taus=numpy.array([tau for tau, _ in ours]))
their_seconds = time.perf_counter() - start

theirs = dict(zip((round(tau * RATE) for tau in taus), deviations))
both = [(tau, deviation, theirs[round(tau * RATE)]) for tau, deviation in ours if round(tau * RATE) in theirs]
worst = max(abs(a / b - 1.0) for _, a, b in both)
print(f"[ FIGURE   ] Allan deviation of 10 M samples at {len(both)} taus: largest difference from allantools {worst:.1e}")
print(f"[ FIGURE   ] {seconds:.3f} s against {their_seconds:.2f} s: {their_seconds / seconds:.1f} times faster")
sys.exit(0 if worst < 1e-9 and len(both) >= len(ours) - 1 else 1)
