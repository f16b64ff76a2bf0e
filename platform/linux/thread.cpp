#include "platform/linux/thread.h"

#include <sched.h>
#include <semaphore.h>

#include <cassert>
#include <cerrno>
#include <climits>
#include <memory>
#include <utility>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

// Lives on the heap until the body has returned; `ready` and `report` belong to the starter and are
// not touched after sem_post().
struct Start {
  ThreadOptions options;
  std::function<void()> body;
  Report* report = nullptr;
  sem_t* ready = nullptr;
};

void take_cpus(const ThreadOptions& options, Report& report) {
  if (options.cpus == 0) return;
  cpu_set_t set;
  CPU_ZERO(&set);
  for (unsigned cpu = 0; cpu < 64; ++cpu) {
    if ((options.cpus >> cpu & 1U) != 0) CPU_SET(cpu, &set);
  }
  const int error = pthread_setaffinity_np(pthread_self(), sizeof(set), &set);
  if (error == 0) return;
  report.push_back("thread " + options.name +
                   " runs on any CPU: the asked ones were refused: " + errno_text(error) +
                   "; name CPUs that this board has and that the unit allows (AllowedCPUs=)");
}

void take_priority(const ThreadOptions& options, Report& report) {
  if (options.fifo_priority == 0) return;
  sched_param param = {};
  param.sched_priority = options.fifo_priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &param);
  if (error == 0) return;
  const std::string priority = std::to_string(options.fifo_priority);
  report.push_back("thread " + options.name + " has no realtime priority: SCHED_FIFO " + priority +
                   ": " + errno_text(error) + "; set LimitRTPRIO=" + priority +
                   " or more in the unit, or ulimit -r " + priority);
}

void* run(void* argument) {
  const std::unique_ptr<Start> start(static_cast<Start*>(argument));
  pthread_setname_np(pthread_self(), start->options.name.c_str());
  take_cpus(start->options, *start->report);
  take_priority(start->options, *start->report);
  sem_post(start->ready);
  start->body();
  return nullptr;
}

Error cannot_start(const ThreadOptions& options, int error) {
  std::string message = "thread " + options.name + " with a stack of " +
                        std::to_string(options.stack_bytes / 1024) +
                        " KiB does not start: " + errno_text(error);
  if (error == EAGAIN) {
    message +=
        "; with locked memory its stack counts against LimitMEMLOCK=, threads against TasksMax=: "
        "raise what is short";
  } else if (error == EINVAL) {
    message += "; a stack has at least " + std::to_string(PTHREAD_STACK_MIN / 1024) +
               " KiB, in whole pages";
  }
  return {message};
}

}  // namespace

Status Thread::start(const ThreadOptions& options, std::function<void()> body, Report& report) {
  assert(!running_);
  assert(options.name.size() <= 15);
  sem_t ready;
  sem_init(&ready, 0, 0);
  auto start = std::make_unique<Start>(Start{options, std::move(body), &report, &ready});

  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  int error = pthread_attr_setstacksize(&attributes, options.stack_bytes);
  if (error == 0) error = pthread_create(&thread_, &attributes, run, start.get());
  pthread_attr_destroy(&attributes);
  if (error == 0) {
    (void)start.release();  // the thread's now
    running_ = true;
    while (sem_wait(&ready) != 0 && errno == EINTR) {
    }
  }
  sem_destroy(&ready);
  if (error != 0) return cannot_start(options, error);
  return {};
}

void Thread::join() {
  if (!running_) return;
  pthread_join(thread_, nullptr);
  running_ = false;
}

}  // namespace zenith
