// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace parts::bench {

/// Wall and processor time since its making. Processor time (of all threads of
/// this process) is what to compare on a machine that does other work too.
class Stopwatch {
 public:
  Stopwatch();
  double wall() const;  ///< seconds
  double cpu() const;   ///< seconds

 private:
  double wall_, cpu_;
};

struct Times {
  double wall = 0, cpu = 0;  ///< seconds
};

/// The quickest of several runs: at least one, more while they take less than
/// half a second together.
Times best_of(const std::function<void()>& run, int most = 20);

/// What a child process did.
struct Child {
  bool ended = false;           ///< came back with its figures; not killed, not out of time
  std::vector<double> figures;  ///< what the task returned
  double peak = 0;              ///< bytes, highest resident memory of the child
  double grown = 0;             ///< bytes, of it what the task took itself
};

/// Runs a task in a child of its own, so that its memory can be told from
/// others'. The child is stopped after so many seconds.
Child in_child(const std::function<std::vector<double>()>& task, double seconds);

/// A table for people: a title, then columns as wide as their widest entry.
class Table {
 public:
  Table(std::string title, std::vector<std::string> head);
  void row(std::vector<std::string> cells);
  void note(const std::string& line) { notes_.push_back(line); }
  ~Table();  ///< prints what the rows did not print yet

 private:
  std::string title_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::string> notes_;
};

enum class Better { Lower, Higher };

/// Says a figure of accuracy, which does not depend on the machine, to
/// tools/ratchet: a line `name,lower|higher,value` in the file $PARTS_FIGURES, where that is set.
void figure(const std::string& name, Better better, double value);

std::string text(double value, int digits = 3);  ///< that many significant digits
std::string count(double value);                 ///< "12,345"
std::string ratio(double value);                 ///< "12.3×"
std::string megabytes(double bytes);             ///< "35 MB"
std::string verdict(bool good);                  ///< "yes" or "NO"

}  // namespace parts::bench
