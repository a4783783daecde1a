// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "parts/base/error.h"

namespace parts {

/// How a long computation speaks to its caller: stage, share done, measured
/// figures; and how the caller stops it. A default-made one is silent. The share
/// reported never falls, also where a step is tried again.
class Progress {
 public:
  /// @param report called with (percent 0..100, stage); false means cancel
  /// @param log    called with each measured figure, "name: value"
  using Report = std::function<bool(int percent, const char* stage)>;
  using Log = std::function<void(const std::string& line)>;

  Progress() = default;
  explicit Progress(Report report, Log log = {}) : log_(std::move(log)) {
    if (!report) return;
    report_ = [report = std::move(report), reached = std::make_shared<std::atomic<int>>(0)](int percent,
                                                                                            const char* name) {
      *reached = std::max(reached->load(), percent);
      return report(*reached, name);
    };
  }

  /// Enters a stage that covers [from, to] percent of the whole.
  void stage(const char* name, int from, int to) {
    name_ = name, from_ = from, to_ = to;
    at(0.0);
  }
  /// Share (0..1) of the current stage that is done. Throws Cancelled.
  void at(double share) {
    if (report_ && !report_(from_ + int(share * (to_ - from_)), name_)) throw Cancelled();
  }
  /// A view of this one for a step that covers [from, to] percent of it.
  Progress part(int from, int to) const {
    Progress view({}, log_);
    if (report_)
      view.report_ = [report = report_, from, to](int percent, const char* name) {
        return report(from + percent * (to - from) / 100, name);
      };
    return view;
  }
  void log(const std::string& line) {
    if (log_) log_(line);
  }

 private:
  Report report_;
  Log log_;
  const char* name_ = "";
  int from_ = 0, to_ = 100;
};

}  // namespace parts
