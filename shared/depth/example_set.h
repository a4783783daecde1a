// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/depth/gallery.h"
#include "parts/depth/reconstruct_depth.h"

namespace parts {

/// The examples in use, and how they change while the depth takes shape
/// (thesis 4.1.3).
class ExampleSet {
 public:
  /// Starts with the objects that look most like the query.
  /// @param small  the query at the scale of gallery.small
  ExampleSet(Gallery& gallery, const DepthOptions& options, const std::vector<View>& views, const PatchImage& small);

  size_t size() const { return all_.size(); }
  const Prepared& operator[](size_t k) const { return all_[k]; }
  PatchImage front(size_t k) const;  ///< {intensity, depth}, for the optimisation
  Gallery& gallery() const { return gallery_; }

  /// The least used quarter gives way to the objects whose depth is most like
  /// the estimate; with several views in use, the least used view to the mean of
  /// the angles, weighted by their patches, unless one in use is as good.
  ExampleChange update(const SynthesisState& state);

 private:
  std::vector<int> nearest_objects(const SynthesisState& state, const View& view, int count) const;
  bool in_use(const SynthesisState& state, int object, const View& view) const;
  void add(int object, const View& view, ExampleChange& change);

  Gallery& gallery_;
  const DepthOptions& options_;
  std::vector<Prepared> all_;
};

}  // namespace parts
