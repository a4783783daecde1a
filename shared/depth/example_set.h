// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parts/depth/gallery.h"
#include "parts/depth/options.h"
#include "parts/synthesis/synthesis.h"

namespace parts::depth {

/// The examples in use, and how they change while the depth takes shape
/// (thesis 4.1.3).
class ExampleSet {
 public:
  /// Starts with the objects that look most like the query.
  /// @param small  the query at the scale of gallery.small
  ExampleSet(Gallery& gallery, const DepthOptions& options, const std::vector<render::View>& views,
             const synthesis::PatchImage& small);

  size_t size() const { return all_.size(); }
  const ComparableExample& operator[](size_t k) const { return all_[k]; }
  synthesis::PatchImage front(size_t k) const;  ///< {intensity, depth}, for the optimisation
  Gallery& gallery() const { return gallery_; }

  /// The least used quarter gives way to the objects whose depth is most like
  /// the estimate; with several views in use, the least used view to the mean of
  /// the angles, weighted by their patches, unless one in use is as good.
  synthesis::ExampleChange update(const synthesis::SynthesisState& state);

 private:
  std::vector<int> nearest_objects(const synthesis::SynthesisState& state, const render::View& view, int count) const;
  bool in_use(const synthesis::SynthesisState& state, int object, const render::View& view) const;
  void add(int object, const render::View& view, synthesis::ExampleChange& change);

  Gallery& gallery_;
  const DepthOptions& options_;
  std::vector<ComparableExample> all_;
};

}  // namespace parts::depth
