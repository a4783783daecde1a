// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "parts/depth/reconstruct_depth.h"
#include "parts/examples/example.h"

/// The depth of a member of a class by the others, beside what they say without
/// any reconstruction.
namespace parts::bench {

/// A class, one object kept out.
class Others : public examples::ExampleSource {
 public:
  Others(examples::ExampleSource& all, int without) : all_(all), without_(without) {}
  int size() const override { return all_.size() - (without_ >= 0); }
  const std::string& name(int k) const override { return all_.name(of(k)); }
  cv::Size image_size() const override { return all_.image_size(); }
  std::vector<render::View> views(int k) const override { return all_.views(of(k)); }
  examples::Example get(int k, const render::View& view) override { return all_.get(of(k), view); }
  std::optional<examples::Light> light() const override { return all_.light(); }
  void set_light(const examples::Light& light) override { all_.set_light(light); }
  const io::ClassPreset& preset() const override { return all_.preset(); }

 private:
  int of(int k) const { return without_ >= 0 && k >= without_ ? k + 1 : k; }
  examples::ExampleSource& all_;
  int without_;
};

/// Of the models in data/NAME.
std::unique_ptr<examples::ExampleSource> open_class(const std::string& name, int width = 150, int height = 200);

struct Error {
  double offset = 0, scale = 0, angle = 0;  ///< shares of the depth range, degrees
  double roughness = 0;                     ///< away from the silhouette, as a multiple of the truth's
  void add(const Error& e, double share) {
    offset += e.offset * share, scale += e.scale * share, angle += e.angle * share;
    roughness += e.roughness * share;
  }
};

struct Score {
  Error ours, mean, nearest, back, back_mean;
  double wall = 0, cpu = 0, angle = 0;
  int count = 0, found = 0;
};

/// Reconstructs a query from examples that it is none of, and compares with what they say otherwise.
/// @param view   of the query
/// @param share  of this query in the score
depth::DepthResult compare_with_others(examples::ExampleSource& others, const examples::Example& query,
                                       const render::View& view, const depth::DepthOptions& options, double share,
                                       Score& score);

/// One query, and what the others say of it.
/// @param queries  where the query is rendered, if not like the others
void measure(examples::ExampleSource& all, int k, const render::View& view, const depth::DepthOptions& options,
             double share, Score& score, examples::ExampleSource* queries = nullptr);

}  // namespace parts::bench
