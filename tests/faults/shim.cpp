// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Preloaded, it makes the calls of a program fail as a full disk or a broken one does. TRUNNION_FAULT is
//   write N | fsync N | rename N | open N | read N   the N-th call on a regular file fails (ENOSPC, EIO, EACCES,
//   EMFILE, EIO)
//   full N                                                         ... and every write after it, as of a full disk
//   dribble SEED                                                   reads and writes are interrupted now and then, and
//   short
// TRUNNION_CALLS names a file that takes how many calls of the kind there were.

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

struct Fault {
  Fault() {
    const char* text = std::getenv("TRUNNION_FAULT");
    if (text == nullptr) return;
    const std::string all = text;
    kind = all.substr(0, all.find(' '));
    number = std::atol(all.c_str() + kind.size());
  }
  ~Fault() {
    const char* path = std::getenv("TRUNNION_CALLS");
    if (path == nullptr) return;
    std::FILE* file = std::fopen(path, "w");
    if (file == nullptr) return;
    std::fprintf(file, "%ld\n", calls.load());
    std::fclose(file);
  }
  std::string kind;
  long number = 0;
  std::atomic<long> calls{0};
};

Fault& fault() {
  static Fault one;
  return one;
}

/// Whether this call is the one that fails.
bool strikes(const char* kind, int error) {
  Fault& f = fault();
  if (f.kind == "full" && std::strcmp(kind, "write") == 0) {
    if (++f.calls < f.number) return false;
  } else if (f.kind != kind || ++f.calls != f.number) {
    return false;
  }
  errno = error;
  return true;
}

bool is_regular(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

/// Bytes of the next call when everything dribbles; -1: interrupted.
long dribbled(std::size_t count) {
  static std::atomic<unsigned long> state{0};
  const unsigned long seed = 0x9e3779b97f4a7c15UL * static_cast<unsigned long>(fault().number + 1);
  unsigned long n = (++state ^ seed) * 6364136223846793005UL;
  n = (n ^ (n >> 29U)) * 0xbf58476d1ce4e5b9UL;
  if (((n >> 40U) & 3U) == 0) {
    errno = EINTR;
    return -1;
  }
  const std::size_t most = 1 + ((n >> 33U) & 0xfffU);
  return static_cast<long>(count < most ? count : most);
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* bytes, std::size_t count) {
  static const auto real = next<ssize_t (*)(int, const void*, std::size_t)>("write");
  if (is_regular(descriptor)) {
    if (strikes("write", ENOSPC)) return -1;
    if (fault().kind == "dribble") {
      const long some = dribbled(count);
      return some < 0 ? -1 : real(descriptor, bytes, static_cast<std::size_t>(some));
    }
  }
  return real(descriptor, bytes, count);
}

ssize_t read(int descriptor, void* bytes, std::size_t count) {
  static const auto real = next<ssize_t (*)(int, void*, std::size_t)>("read");
  if (is_regular(descriptor)) {
    if (strikes("read", EIO)) return -1;
    if (fault().kind == "dribble") {
      const long some = dribbled(count);
      return some < 0 ? -1 : real(descriptor, bytes, static_cast<std::size_t>(some));
    }
  }
  return real(descriptor, bytes, count);
}

int fsync(int descriptor) {
  static const auto real = next<int (*)(int)>("fsync");
  return strikes("fsync", EIO) ? -1 : real(descriptor);
}

int rename(const char* from, const char* to) {
  static const auto real = next<int (*)(const char*, const char*)>("rename");
  return strikes("rename", EACCES) ? -1 : real(from, to);
}

int open(const char* path, int flags, ...) {
  static const auto real = next<int (*)(const char*, int, ...)>("open");
  mode_t mode = 0;
  if ((flags & O_CREAT) != 0) {
    va_list arguments;
    va_start(arguments, flags);
    mode = va_arg(arguments, mode_t);
    va_end(arguments);
  }
  if (std::strncmp(path, "/proc", 5) != 0 && std::strncmp(path, "/sys", 4) != 0 && strikes("open", EMFILE)) return -1;
  return real(path, flags, mode);
}

}  // extern "C"
