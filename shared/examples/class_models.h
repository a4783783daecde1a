// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <list>
#include <memory>
#include <vector>

#include "parts/examples/render_example.h"
#include "parts/io/model_database.h"

namespace parts::examples {

/// The usable models of a database in the frame of their class, in memory as
/// far as a bound allows and read again beyond that.
class ClassModels {
 public:
  /// Reads every model once. @param views  in which every model must fit
  /// @throws UserError  none can be read
  ClassModels(const io::ModelDatabase& database, const std::vector<render::View>& views, const ExampleOptions& options,
              Progress& progress);

  int size() const { return int(entries_.size()); }
  const std::string& name(int i) const { return entries_[i].name; }
  double frame() const { return frame_; }  ///< see render_example
  std::vector<std::string> files() const;  ///< models and textures
  /// ClassModel::size of a model with such a diagonal: that of the others, if it is about as large.
  double shown_size(double diagonal) const;
  /// Valid until the next call.
  const ClassModel& get(int i);

 private:
  struct Entry {
    int model;  ///< of the database
    std::string name;
    std::vector<std::string> textures;
    Vec3 center;
    double diagonal, size;
    Eigen::Vector2d extent;  ///< largest in all views
    std::unique_ptr<ClassModel> loaded;
    double bytes = 0;
  };
  std::string measure(const std::vector<render::View>& views, Progress& progress);
  void settle_frame(Progress& progress);
  void keep(int i, Mesh mesh);
  void forget_beyond_bound(int but);

  io::ModelDatabase database_;
  ExampleOptions options_;
  std::vector<Entry> entries_;
  std::list<int> recent_;  ///< loaded ones, the last used first
  double frame_ = 1, median_ = 1, bytes_ = 0;
};

}  // namespace parts::examples
