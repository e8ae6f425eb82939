// Preloaded into a process: its wall clock is off by what a file says, everything else is as it was.
//
// The file named by DOORMILL_TEST_WALL_CLOCK holds one number, nanoseconds as int64 in the machine's order, and is
// mapped, so that one write sets the clocks of all processes at once. A wait until a time of the wall clock is handed
// to the system by its own clock; one that is under way when the clock is set ends when it would have ended.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace {
constexpr int64_t SECOND = 1000000000;
// What is below is a time of the steady clock, which begins with the machine.
constexpr time_t FIRST_DAY = 1000000000;

int64_t offset() {
  static const volatile int64_t* shown = [] {
    static const int64_t none = 0;
    const char* path = std::getenv("DOORMILL_TEST_WALL_CLOCK");
    const int file = path ? ::open(path, O_RDONLY | O_CLOEXEC) : -1;
    if (file < 0) return &none;
    void* page = ::mmap(nullptr, sizeof(int64_t), PROT_READ, MAP_SHARED, file, 0);
    ::close(file);
    return page == MAP_FAILED ? &none : static_cast<const int64_t*>(page);
  }();
  return *shown;
}

timespec moved(const timespec& time, int64_t by) {
  int64_t sum = time.tv_sec * SECOND + time.tv_nsec + by;
  if (sum < 0) sum = 0;
  return {static_cast<time_t>(sum / SECOND), static_cast<long>(sum % SECOND)};
}

timespec of_the_system(const timespec* time) {
  return time->tv_sec < FIRST_DAY ? *time : moved(*time, -offset());
}

template <typename Function>
Function next(const char* name, Function) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

bool is_wall(clockid_t clock) { return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE; }
}  // namespace

extern "C" {
int clock_gettime(clockid_t clock, timespec* time) noexcept {
  static auto real = next("clock_gettime", &clock_gettime);
  const int status = real(clock, time);
  if (status == 0 && is_wall(clock)) *time = moved(*time, offset());
  return status;
}

int gettimeofday(timeval* time, void*) noexcept {
  timespec now;
  if (clock_gettime(CLOCK_REALTIME, &now) != 0) return -1;
  *time = {now.tv_sec, now.tv_nsec / 1000};
  return 0;
}

time_t time(time_t* where) noexcept {
  timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (where) *where = now.tv_sec;
  return now.tv_sec;
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const timespec* until) {
  static auto real = next("pthread_cond_timedwait", &pthread_cond_timedwait);
  const timespec meant = of_the_system(until);
  return real(condition, mutex, &meant);
}

int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* until) noexcept {
  static auto real = next("pthread_mutex_timedlock", &pthread_mutex_timedlock);
  const timespec meant = of_the_system(until);
  return real(mutex, &meant);
}

int sem_timedwait(sem_t* semaphore, const timespec* until) {
  static auto real = next("sem_timedwait", &sem_timedwait);
  const timespec meant = of_the_system(until);
  return real(semaphore, &meant);
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* left) {
  static auto real = next("clock_nanosleep", &clock_nanosleep);
  const timespec meant = flags & TIMER_ABSTIME ? of_the_system(time) : *time;
  return real(clock, flags, &meant, left);
}
}
