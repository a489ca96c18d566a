// Preloaded into a program: makes one of its calls fail, as a disk or the memory would.
//   FAULT_CALL   write, sync, open (for writing), read (of files), memory, place: the first
//                allocation on each way through the program, told apart by who calls whom
//   FAULT_NTH    which of these calls, counted from 1 since the program has begun (prepare_process)
//   FAULT_ERROR  enospc, eio, short (half of a write or read, then nothing wrong); not of memory
//   FAULT_LASTS  1: that one and all after it
//   FAULT_SEEN   a file that is made when the call is reached
// Only calls on regular files count: messages and what the system's libraries do otherwise go on.

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>
#include <unwind.h>

extern "C" {
void* __libc_malloc(std::size_t);               // NOLINT: glibc's own names
void* __libc_calloc(std::size_t, std::size_t);  // NOLINT
void* __libc_realloc(void*, std::size_t);       // NOLINT
}

namespace {

enum class Call { none, write, sync, open, read, memory, place };
enum class Outcome { good, failed, cut };

std::atomic<bool> begun = false;
std::atomic<long> calls = 0;
std::atomic<bool> seen = false;

struct Plan {
  Call call = Call::none;
  long nth = 0;
  int error = EIO;
  bool cut = false, lasts = false;
  const char* seen = nullptr;
};
Plan plan;

/// Before main, with what the system gives: no C++ library has begun yet.
__attribute__((constructor)) void read_plan() {
  const auto is = [](const char* name, const char* value) {
    const char* const set = std::getenv(name);
    return set && std::strcmp(set, value) == 0;
  };
  const struct {
    const char* name;
    Call call;
  } names[] = {{"write", Call::write}, {"sync", Call::sync},     {"open", Call::open},
               {"read", Call::read},   {"memory", Call::memory}, {"place", Call::place}};
  for (const auto& [name, call] : names) {
    if (is("FAULT_CALL", name)) plan.call = call;
  }
  if (const char* nth = std::getenv("FAULT_NTH")) plan.nth = std::atol(nth);
  if (is("FAULT_ERROR", "enospc")) plan.error = ENOSPC;
  plan.cut = is("FAULT_ERROR", "short");
  plan.lasts = is("FAULT_LASTS", "1");
  plan.seen = std::getenv("FAULT_SEEN");
}

Outcome outcome(Call call) {
  if (call != plan.call || !begun) return Outcome::good;
  const long number = ++calls;
  if (number < plan.nth || (number > plan.nth && !plan.lasts)) return Outcome::good;
  if (plan.seen && !seen.exchange(true)) {
    const long file = syscall(SYS_openat, AT_FDCWD, plan.seen, O_CREAT | O_WRONLY, 0644);
    if (file >= 0) syscall(SYS_close, file);
  }
  errno = call == Call::memory || call == Call::place ? ENOMEM : plan.error;
  return plan.cut ? Outcome::cut : Outcome::failed;
}

Outcome outcome_at(Call call, int file) {
  struct stat status {};
  if (call != plan.call || fstat(file, &status) != 0 || !S_ISREG(status.st_mode))
    return Outcome::good;
  return outcome(call);
}

/// The callers of an allocation, as one number: as many as tell our own places apart and do not
/// count each depth of a library's recursion.
std::uint64_t way_here() {
  constexpr int depth = 8;
  struct Walk {
    std::uint64_t hash = 0xCBF29CE484222325ULL;
    int left = depth;
  } walk;
  _Unwind_Backtrace(
      [](_Unwind_Context* context, void* data) {
        auto& so_far = *static_cast<Walk*>(data);
        so_far.hash = (so_far.hash ^ _Unwind_GetIP(context)) * 0x100000001B3ULL;
        return --so_far.left > 0 ? _URC_NO_REASON : _URC_END_OF_STACK;
      },
      &walk);
  return walk.hash | 1U;
}

/// True for the first allocation on its way.
bool is_new_place() {
  static std::atomic<std::uint64_t> known[1 << 16];
  const std::uint64_t way = way_here();
  for (std::size_t at = way >> 20;; ++at) {
    std::uint64_t there = 0;
    std::atomic<std::uint64_t>& slot = known[at % std::size(known)];
    if (slot.compare_exchange_strong(there, way)) return true;
    if (there == way) return false;
  }
}

Outcome outcome_of_allocation() {
  if (plan.call == Call::memory) return outcome(Call::memory);
  static thread_local bool looking = false;  // the look itself may allocate
  if (plan.call != Call::place || !begun || looking) return Outcome::good;
  looking = true;
  const bool counts = is_new_place();
  looking = false;
  return counts ? outcome(Call::place) : Outcome::good;
}

/// What of so many bytes is to be done, or -1.
ssize_t part_of(std::size_t count, Outcome outcome) {
  if (outcome == Outcome::failed) return -1;
  return static_cast<ssize_t>(outcome == Outcome::cut && count > 1 ? count / 2 : count);
}

bool for_writing(int flags) { return (flags & (O_WRONLY | O_RDWR | O_CREAT)) != 0; }

int open_at(int folder, const char* path, int flags, mode_t mode) {
  if (for_writing(flags) && outcome(Call::open) != Outcome::good) return -1;
  return static_cast<int>(syscall(SYS_openat, folder, path, flags, mode));
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

std::FILE* open_stream(const char* name, const char* path, const char* mode) {
  const bool write = std::strpbrk(mode, "wa+") != nullptr;
  if (write && outcome(Call::open) != Outcome::good) return nullptr;
  return next<std::FILE* (*)(const char*, const char*)>(name)(path, mode);
}

}  // namespace

extern "C" {

// The program's first own call, before which there is nobody who could tell of a failure.
sighandler_t signal(int number, sighandler_t handler) {
  if (number == SIGPIPE) begun = true;
  return next<sighandler_t (*)(int, sighandler_t)>("signal")(number, handler);
}

ssize_t write(int file, const void* bytes, std::size_t count) {
  const ssize_t part = part_of(count, outcome_at(Call::write, file));
  return part < 0 ? -1 : syscall(SYS_write, file, bytes, part);
}
ssize_t pwrite64(int file, const void* bytes, std::size_t count, off64_t at) {
  const ssize_t part = part_of(count, outcome_at(Call::write, file));
  return part < 0 ? -1 : syscall(SYS_pwrite64, file, bytes, part, at);
}
ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t at) {
  return pwrite64(file, bytes, count, at);
}
ssize_t writev(int file, const iovec* pieces, int count) {
  const Outcome how = outcome_at(Call::write, file);
  if (how == Outcome::failed) return -1;
  return syscall(SYS_writev, file, pieces, how == Outcome::cut ? 1 : count);
}
int ftruncate64(int file, off64_t size) {
  if (outcome_at(Call::write, file) == Outcome::failed) return -1;
  return static_cast<int>(syscall(SYS_ftruncate, file, size));
}
int ftruncate(int file, off_t size) { return ftruncate64(file, size); }
ssize_t read(int file, void* bytes, std::size_t count) {
  const ssize_t part = part_of(count, outcome_at(Call::read, file));
  return part < 0 ? -1 : syscall(SYS_read, file, bytes, part);
}
ssize_t pread64(int file, void* bytes, std::size_t count, off64_t at) {
  const ssize_t part = part_of(count, outcome_at(Call::read, file));
  return part < 0 ? -1 : syscall(SYS_pread64, file, bytes, part, at);
}
ssize_t pread(int file, void* bytes, std::size_t count, off_t at) {
  return pread64(file, bytes, count, at);
}
int fsync(int file) {
  if (outcome_at(Call::sync, file) == Outcome::failed) return -1;
  return static_cast<int>(syscall(SYS_fsync, file));
}
int fdatasync(int file) {
  if (outcome_at(Call::sync, file) == Outcome::failed) return -1;
  return static_cast<int>(syscall(SYS_fdatasync, file));
}
int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return open_at(AT_FDCWD, path, flags, mode);
}
int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return open_at(AT_FDCWD, path, flags, mode);
}
std::FILE* fopen(const char* path, const char* mode) { return open_stream("fopen", path, mode); }
std::FILE* fopen64(const char* path, const char* mode) {
  return open_stream("fopen64", path, mode);
}

void* malloc(std::size_t size) {
  return outcome_of_allocation() == Outcome::good ? __libc_malloc(size) : nullptr;
}
void* calloc(std::size_t count, std::size_t size) {
  return outcome_of_allocation() == Outcome::good ? __libc_calloc(count, size) : nullptr;
}
void* realloc(void* block, std::size_t size) {
  return outcome_of_allocation() == Outcome::good ? __libc_realloc(block, size) : nullptr;
}

}  // extern "C"
