// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "parts/colorize/options.h"
#include "parts/colorize/report.h"
#include "parts/examples/example.h"
#include "parts/synthesis/synthesis.h"

/// What the colouring of depth maps and of meshes have in common: which objects
/// give their colours, as which planes, and how these are weighed.
namespace parts::colorize {

/// The planes of an example. Colours are 0..1; the relief is depth about its
/// mean, in pixels.
enum ColorPlane { kReliefPlane, kYPlane, kCbPlane, kCrPlane };

struct ColorExample {
  int object = 0;
  std::string name;
  double difference = 0;        ///< of its relief to the query's, squared pixels
  synthesis::PatchImage image;  ///< as ColorPlane says
};

synthesis::PatchImage color_planes(const examples::Example& example);
/// @param depth  32F, NaN = background, which becomes 0
cv::Mat relief(const cv::Mat& depth, const cv::Mat& mask, double pixels_per_unit);
/// The relief's standard deviation over the foreground.
double relief_spread(const synthesis::PatchImage& image);

/// Mean squared difference of two reliefs, pixels; where one has no foreground,
/// as large as the larger relief.
/// @param centered  centroid on centroid
double relief_difference(const synthesis::PatchImage& a, const synthesis::PatchImage& b, bool centered);

/// The objects that may give colours, by their numbers: all, or those named.
/// @param names  of each object; labels may leave the file's ending out
/// @throws UserError  a label that no object has
std::vector<int> choosable(const std::vector<std::string>& names, const std::vector<std::string>& labels);

/// Takes off an example what makes it differ from another all over: exposure or
/// tint. What differs here and there (a red coat and a blue one) is no tint.
/// @return whether there was such a difference
bool harmonize(synthesis::PatchImage& image, const synthesis::PatchImage& like, bool centered);

/// The share of the surface where two examples have other colours: put together
/// they would give patchwork. With options.harmonize after taking off what
/// differs all over.
double discord(const synthesis::PatchImage& image, const synthesis::PatchImage& like, const ColorizeOptions& options);

/// Sorts by similarity of shape and keeps options.examples of them: the most
/// similar one, and others that go with its colours; fewer where too few do,
/// as the result would be patchwork (thesis Fig. 31). With a seed the first is
/// drawn among the better half. Those chosen by name are all kept.
/// @param kept  colours of the query that stay, with which the examples' are to
///              go; an empty mask: none
/// @throws UserError  options.examples is below 1
void select_examples(std::vector<ColorExample>& all, const synthesis::PatchImage& query,
                     const synthesis::PatchImage& kept, const ColorizeOptions& options, ColorizeReport& report);

/// The engine's channels and weights.
synthesis::SynthesisOptions color_synthesis(const ColorizeOptions& options);

/// BGR, 8 bits, from Y, Cb and Cr as 32F.
cv::Mat to_color(const std::vector<cv::Mat>& ycbcr);

/// The examples' images, harmonised with the first one's. Fills used and harmonized.
std::vector<synthesis::PatchImage> prepare_examples(std::vector<ColorExample> examples, const ColorizeOptions& options,
                                                    ColorizeReport& report);

/// Fills shares, objective and patch_distance.
void report_synthesis(const synthesis::SynthesisResult& found, const cv::Mat& mask, ColorizeReport& report);

}  // namespace parts::colorize
