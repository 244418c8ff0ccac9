// SPDX-License-Identifier: Apache-2.0
// Stands between this test program and the C library: allocation, locks, system calls. System calls are
// caught by Linux' syscall user dispatch (5.11 and later): a byte that the kernel looks at before each call
// of this thread.
#include "tests/machine_run/rig/watch.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SERVOGATE_SANITIZED 1
#else
#define SERVOGATE_SANITIZED 0
#endif

#ifndef PR_SET_SYSCALL_USER_DISPATCH
#define PR_SET_SYSCALL_USER_DISPATCH 59
#endif

namespace {

constexpr char kAllow = 0, kBlock = 1;

thread_local bool watching = false;
volatile char selector = kAllow;
long allocations = 0, locks = 0, system_calls = 0, first_system_call = -1;

[[maybe_unused]] void count(long& what) noexcept {
  if (watching) ++what;
}

#if defined(__x86_64__)
void on_system_call(int, siginfo_t* info, void*) {
  // Let go for the rest of this watch: the return from this handler is a system call itself.
  selector = kAllow;
  ++system_calls;
  if (first_system_call < 0) first_system_call = info->si_syscall;
}

std::string begin_dispatch() {
  // The check of virtual calls asks by a system call whether memory can be read, and believes a refusal.
  if (SERVOGATE_SANITIZED) return "sanitizers make system calls of their own";
  struct sigaction action {};
  action.sa_sigaction = on_system_call;
  action.sa_flags = SA_SIGINFO;
  if (sigaction(SIGSYS, &action, nullptr) != 0) return std::strerror(errno);
  if (prctl(PR_SET_SYSCALL_USER_DISPATCH, 1, 0, 0, &selector) != 0)
    return std::string("this kernel has no syscall user dispatch: ") + std::strerror(errno);
  return {};
}
#else
std::string begin_dispatch() { return "syscall user dispatch is used on x86-64 only"; }
#endif

/// Asked for by the watched thread; the answer holds for it.
const std::string& dispatch() {
  thread_local const std::string refusal = begin_dispatch();
  return refusal;
}

}  // namespace

namespace servogate::machine_run {

std::string Offences::words() const {
  return std::to_string(allocations) + " allocations, " + std::to_string(locks) + " locks, " +
         std::to_string(system_calls) + " system calls (first: number " + std::to_string(first_system_call) +
         ")";
}

Watch::Watch() {
  const bool calls = dispatch().empty();
  watching = true;
  if (calls) selector = kBlock;
}

Watch::~Watch() {
  selector = kAllow;
  watching = false;
}

Offences Watch::offences() { return {allocations, locks, system_calls, first_system_call}; }
void Watch::forget() {
  allocations = locks = system_calls = 0;
  first_system_call = -1;
}
std::string Watch::no_system_calls() { return dispatch(); }
std::string Watch::no_allocations() {
  return SERVOGATE_SANITIZED ? "sanitizers put their own allocator in place" : "";
}

}  // namespace servogate::machine_run

#if !SERVOGATE_SANITIZED
extern "C" {
void* __libc_malloc(std::size_t);
void __libc_free(void*);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  count(allocations);
  return __libc_malloc(size);
}
void free(void* memory) {
  count(allocations);
  __libc_free(memory);
}
void* calloc(std::size_t n, std::size_t size) {
  count(allocations);
  return __libc_calloc(n, size);
}
void* realloc(void* memory, std::size_t size) {
  count(allocations);
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count(allocations);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  count(allocations);
  *out = __libc_memalign(alignment, size);
  return *out != nullptr ? 0 : ENOMEM;
}

// operator new of the C++ library calls malloc and is counted there.

#define SERVOGATE_LOCK(name, type)                                                    \
  int name(type* object) {                                                            \
    using Function = int (*)(type*);                                                  \
    static const Function next = reinterpret_cast<Function>(dlsym(RTLD_NEXT, #name)); \
    count(locks);                                                                     \
    return next(object);                                                              \
  }
SERVOGATE_LOCK(pthread_mutex_lock, pthread_mutex_t)
SERVOGATE_LOCK(pthread_mutex_trylock, pthread_mutex_t)
SERVOGATE_LOCK(pthread_rwlock_rdlock, pthread_rwlock_t)
SERVOGATE_LOCK(pthread_rwlock_wrlock, pthread_rwlock_t)
SERVOGATE_LOCK(pthread_cond_signal, pthread_cond_t)
SERVOGATE_LOCK(pthread_cond_broadcast, pthread_cond_t)
#undef SERVOGATE_LOCK
}
#endif
