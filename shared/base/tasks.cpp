// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/base/tasks.h"

#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <thread>

#include "parts/base/arena.h"

namespace parts {
namespace {

class Run {
 public:
  Run(int n, Progress& progress, const std::function<void(int, const Poll&)>& body)
      : n_(n), progress_(progress), body_(body) {}

  void on(int threads) {
    if (threads <= 1) {
      work([this] { speak(); });
    } else {
      in_arena(threads, [&] { share(threads); });
    }
    if (error_) std::rethrow_exception(error_);
  }

 private:
  using Clock = std::chrono::steady_clock;

  struct Helper {
    Run& run;
    [[gnu::no_sanitize("thread")]] void operator()() const { run.help(); }  // reads what TBB has handed over
  };

  void share(int threads) {
    tbb::task_group helpers;
    hand_over();
    for (int t = 1; t < threads; ++t) helpers.run(Helper{*this});
    work([this] { speak(); });
    try {  // others may still be busy
      while (done_ < n_ && !failed_) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        speak();
      }
    } catch (...) {
      fail();
    }
    helpers.wait();
    take_over();
  }

  void help() {
    take_over();
    work([this] { check(); });
    hand_over();
  }

  void work(const Poll& poll) {
    try {
      for (int i = next_++; i < n_ && !failed_; i = next_++) {
        poll();
        body_(i, poll);
        ++done_;
      }
    } catch (...) {
      fail();
    }
  }

  void check() const {
    if (failed_) throw Cancelled();
  }

  void speak() {
    check();
    if (Clock::now() - spoken_ < std::chrono::milliseconds(50)) return;
    progress_.at(double(done_) / n_);
    spoken_ = Clock::now();
  }

  void fail() {
    if (!failed_.exchange(true)) error_ = std::current_exception();
  }

  const int n_;
  Progress& progress_;
  const std::function<void(int, const Poll&)>& body_;
  std::atomic<int> next_{0}, done_{0};
  std::atomic<bool> failed_{false};
  std::exception_ptr error_;  ///< the first one
  Clock::time_point spoken_ = Clock::now();
};

}  // namespace

void run_tasks(int n, int threads, Progress& progress, const std::function<void(int, const Poll&)>& body) {
  Run(n, progress, body).on(std::min(threads, n));
}

}  // namespace parts
