// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "parts/base/progress.h"

namespace parts {

/// What a task calls at least every 0.1 s: throws Cancelled once the user has
/// cancelled or another task has failed.
using Poll = std::function<void()>;

/// Runs body(i, poll) for i in [0, n), each on any of up to `threads` threads;
/// the calling thread works too and alone speaks to progress, also while only
/// others are busy. Calls may nest. The first exception is thrown again here
/// after all bodies have ended; no task begins after it.
void run_tasks(int n, int threads, Progress& progress, const std::function<void(int i, const Poll& poll)>& body);

}  // namespace parts
