#include "tests/unit/assets/frames/killed_process.h"

#include <csignal>
#include <cstdarg>
#include <fcntl.h>
#include <limits>
#include <stdexcept>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

int operations_left = std::numeric_limits<int>::max();

void count_operation() {
    if (operations_left-- == 0)
        ::raise(SIGKILL);
}

}  // namespace

// These take the place of the system's functions in the whole test program.
extern "C" {

int open(const char* path, int flags, ...) {
    unsigned mode = 0;
    if (flags & O_CREAT) {
        count_operation();
        va_list rest;
        va_start(rest, flags);
        mode = va_arg(rest, unsigned);
        va_end(rest);
    }
    return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

ssize_t write(int file, const void* bytes, size_t n) {
    count_operation();
    // Every other write is cut short: the program has to go on, or the process dies with half of it on disk.
    static bool whole = true;
    whole = !whole;
    return ::syscall(SYS_write, file, bytes, whole || n < 2 ? n : n / 2);
}

int fsync(int file) {
    count_operation();
    return static_cast<int>(::syscall(SYS_fsync, file));
}

int rename(const char* from, const char* to) noexcept {
    count_operation();
    return static_cast<int>(::syscall(SYS_rename, from, to));
}

int unlink(const char* path) noexcept {
    count_operation();
    return static_cast<int>(::syscall(SYS_unlink, path));
}

}  // extern "C"

namespace tests {

bool killed_at_file_operation(const std::function<void()>& work, int n_operations) {
    const pid_t child = ::fork();
    if (child == 0) {
        operations_left = n_operations;
        work();
        ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    const bool killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    if (!killed && !(WIFEXITED(status) && WEXITSTATUS(status) == 0))
        throw std::runtime_error("the process to kill failed by itself");
    return killed;
}

}  // namespace tests
