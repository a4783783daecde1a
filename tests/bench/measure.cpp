// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/measure.h"

#include <malloc.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>

namespace parts::bench {
namespace {

double clock_seconds(clockid_t id) {
  timespec t{};
  clock_gettime(id, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

/// A line of /proc/self/status that is in kB, as bytes.
double status_bytes(const std::string& name) {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind(name + ":", 0) == 0) return 1024 * std::stod(line.substr(name.size() + 1));
  return 0;
}

/// Columns of a UTF-8 text.
std::size_t width(const std::string& s) {
  std::size_t n = 0;
  for (char c : s) n += (c & 0xc0) != 0x80;
  return n;
}

}  // namespace

Stopwatch::Stopwatch() : wall_(clock_seconds(CLOCK_MONOTONIC)), cpu_(clock_seconds(CLOCK_PROCESS_CPUTIME_ID)) {}
double Stopwatch::wall() const { return clock_seconds(CLOCK_MONOTONIC) - wall_; }
double Stopwatch::cpu() const { return clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_; }

void figure(const std::string& name, Better better, double value) {
  const char* file = std::getenv("PARTS_FIGURES");
  if (!file) return;
  std::ofstream out(file, std::ios::app);
  out << '"' << name << "\"," << (better == Better::Lower ? "lower" : "higher") << ',' << text(value, 4) << '\n';
}

Times best_of(const std::function<void()>& run, int most) {
  Times best{1e300, 1e300};
  const Stopwatch all;
  for (int i = 0; i < most && (i == 0 || all.wall() < 0.5); ++i) {
    const Stopwatch one;
    run();
    best = {std::min(best.wall, one.wall()), std::min(best.cpu, one.cpu())};
  }
  return best;
}

Child in_child(const std::function<std::vector<double>()>& task, double seconds) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  std::fflush(nullptr);
  malloc_trim(0);
  const pid_t pid = fork();
  if (pid == 0) {
    close(ends[0]);
    std::ofstream("/proc/self/clear_refs") << 5;  // the high-water mark starts here
    const double before = status_bytes("VmRSS");
    std::vector<double> out;
    try {
      out = task();
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s\n", e.what());
      _exit(1);
    }
    const double peak = status_bytes("VmHWM");
    out.insert(out.end(), {peak, peak - before});
    const std::size_t bytes = out.size() * sizeof(double);
    _exit(write(ends[1], out.data(), bytes) == ssize_t(bytes) ? 0 : 1);
  }
  close(ends[1]);
  Child child;
  pollfd waiting{ends[0], POLLIN, 0};
  if (pid > 0 && poll(&waiting, 1, int(1000 * seconds)) > 0) {
    double buffer[64];
    const ssize_t bytes = read(ends[0], buffer, sizeof buffer);
    if (bytes >= ssize_t(2 * sizeof(double))) {
      child.figures.assign(buffer, buffer + bytes / sizeof(double));
      child.grown = child.figures.back(), child.figures.pop_back();
      child.peak = child.figures.back(), child.figures.pop_back();
      child.ended = true;
    }
  }
  close(ends[0]);
  if (pid > 0) {
    if (!child.ended) kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
  }
  return child;
}

Table::Table(std::string title, std::vector<std::string> head) : title_(std::move(title)) { row(std::move(head)); }

void Table::row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

Table::~Table() {
  std::vector<std::size_t> widths;
  for (const auto& r : rows_)
    for (std::size_t c = 0; c < r.size(); ++c) {
      widths.resize(std::max(widths.size(), c + 1));
      widths[c] = std::max(widths[c], width(r[c]));
    }
  std::printf("\n%s\n\n", title_.c_str());
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t c = 0; c < cells.size(); ++c)
      std::printf("| %s%*s ", cells[c].c_str(), int(widths[c] - width(cells[c])), "");
    std::printf("|\n");
  };
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    line(rows_[r]);
    if (r > 0) continue;
    for (std::size_t w : widths) std::printf("|%s", std::string(w + 2, '-').c_str());
    std::printf("|\n");
  }
  if (!notes_.empty()) std::printf("\n");
  for (const std::string& n : notes_) std::printf("%s\n", n.c_str());
  std::fflush(stdout);
}

std::string text(double value, int digits) {
  if (value == 0) return "0";
  char out[64];
  const int whole = int(std::floor(std::log10(std::abs(value)))) + 1;
  std::snprintf(out, sizeof out, "%.*f", std::max(0, digits - whole), value);
  return out;
}

std::string count(double value) {
  std::string s = std::to_string(std::lround(value));
  for (int at = int(s.size()) - 3; at > 0; at -= 3) s.insert(at, ",");
  return s;
}

std::string ratio(double value) { return text(value) + "×"; }
std::string megabytes(double bytes) { return text(bytes / 1e6) + " MB"; }
std::string verdict(bool good) { return good ? "yes" : "NO"; }

}  // namespace parts::bench
