// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameters.h"

#include <sstream>

#include "parts/base/error.h"
#include "parts/host/common.h"

namespace parts {

using namespace host;

namespace {

constexpr const char* patch_sizes = "9,11,7";

std::vector<std::string> labels(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string label; std::getline(in, label, ';');) {
    const auto begin = label.find_first_not_of(" \t"), end = label.find_last_not_of(" \t");
    if (begin != std::string::npos) all.push_back(label.substr(begin, end - begin + 1));
  }
  return all;
}

}  // namespace

void add_synthesis(std::vector<Parameter>& list) {
  const colorize::ColorizeOptions o;
  const Parameter all[] = {
      integer("Examples", o.examples, 1, 1000, "Examples",
              "How many objects give their colours. 1 morphs one image-map onto the new shape."),
      text("Choose", "", "Choose",
           "Labels of the examples to use, separated by semicolons. Empty: those whose depth is most similar."),
      text("PatchSizes", patch_sizes, "Patch sizes",
           "Windows' sides in pixels, odd, from coarse to fine; as many as there are levels."),
      number("WeightDepth", o.weight_depth, 0, 1e6, "Weight of depth",
             "1: a difference of one standard deviation of the class counts 1."),
      number("WeightHighFrequency", o.weight_detail, 0, 1e6, "Weight of detail", "Of the depth's high frequencies."),
      number("WeightY", o.weight_y, 0, 1e6, "Weight of Y", "Of the brightness found so far."),
      number("WeightCb", o.weight_cb, 0, 1e6, "Weight of Cb", "Of the blueness found so far."),
      number("WeightCr", o.weight_cr, 0, 1e6, "Weight of Cr", "Of the redness found so far."),
      number("WeightPosition", o.weight_position, 0, 1e6, "Weight of position",
             "Of the place relative to the object's middle; lower it for classes without structure."),
      number("PcaShare", o.pca_share, 0.001, 1, "Share of components",
             "Of the principal components of patches by which candidates are looked up. Less is quicker."),
      integer("MaxIterations", o.max_iterations, 1, 1000, "Iterations", "At most so many a level."),
      integer("Seed", 0, 0, 1000000000, "Seed",
              "0: the most similar examples. Other values draw one of the more similar half, for variety."),
  };
  list.insert(list.end(), std::begin(all), std::end(all));
}

void read_synthesis(const Inputs& inputs, const io::ClassPreset& preset, const char* slug,
                    colorize::ColorizeOptions& o) {
  const auto weight = [&](const char* name, double fallback) {
    return class_number(inputs, preset, slug, name, fallback);
  };
  const colorize::ColorizeOptions d;
  o.examples = inputs.integer("Examples");
  o.choose = labels(inputs.text("Choose"));
  o.patch_sizes = parse_patch_sizes(class_text(inputs, preset, slug, "PatchSizes", patch_sizes));
  o.weight_depth = weight("WeightDepth", d.weight_depth);
  o.weight_detail = weight("WeightHighFrequency", d.weight_detail);
  o.weight_y = weight("WeightY", d.weight_y);
  o.weight_cb = weight("WeightCb", d.weight_cb);
  o.weight_cr = weight("WeightCr", d.weight_cr);
  o.weight_position = weight("WeightPosition", d.weight_position);
  o.pca_share = inputs.number("PcaShare");
  o.max_iterations = inputs.integer("MaxIterations");
  o.seed = unsigned(inputs.integer("Seed"));
}

std::string layer_name(const colorize::ColorizeReport& r) {
  return r.trusted() ? "Colorized" : "Colorized (not trusted)";
}

std::string doubt(const colorize::ColorizeReport& r) {
  std::ostringstream text;
  text.precision(2);
  text << "The colours are not to be trusted: the shape is unlike the examples (patches differ by " << r.patch_distance
       << " standard deviations, those of members by less than 1); give models of its class, or say how it stands.";
  return text.str();
}

void log_report(const colorize::ColorizeReport& r, Progress& progress) {
  for (std::size_t k = 0; k < r.used.size(); ++k) {
    std::ostringstream line;
    line << r.used[k] << " " << r.shares[k];
    log_value(progress, "example", line.str());
  }
  if (r.left_out > 0) log_value(progress, "left_out", r.left_out);
  for (const std::string& label : r.harmonized) log_value(progress, "harmonized", label);
  for (std::size_t level = 0; level < r.objective.size(); ++level)
    for (double value : r.objective[level]) log_value(progress, "plausibility", value);
  log_value(progress, "aligned", r.aligned);
  log_value(progress, "patch_distance", r.patch_distance);
}

}  // namespace parts
