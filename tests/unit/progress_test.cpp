// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/base/progress.h"

#include <gtest/gtest.h>

namespace parts {
namespace {

TEST(Progress, NeverFallsThoughAStepIsTriedAgain) {
  std::vector<int> shown;
  std::vector<std::string> stages;
  Progress progress([&](int percent, const char* stage) {
    shown.push_back(percent), stages.push_back(stage);
    return true;
  });
  for (int attempt = 0; attempt < 3; ++attempt) {
    Progress step = progress.part(10, 50);
    step.stage("fitting", 0, 100);
    Progress inner = step.part(50, 100);
    inner.stage("cutting", 0, 100);
    inner.at(0.5);
  }
  progress.stage("done", 90, 100);
  progress.at(-3);  // a caller's mistake
  EXPECT_EQ(shown, (std::vector<int>{10, 30, 40, 40, 40, 40, 40, 40, 40, 90, 90}));
  EXPECT_EQ(stages[3], "fitting") << "the stage's name is still told";
}

TEST(Progress, CancelsFromWithinAStep) {
  Progress progress([](int percent, const char*) { return percent < 50; });
  Progress step = progress.part(40, 80);
  step.stage("working", 0, 100);
  EXPECT_THROW(step.at(0.5), Cancelled);
  EXPECT_NO_THROW(Progress().stage("silent", 0, 1));
}

}  // namespace
}  // namespace parts
