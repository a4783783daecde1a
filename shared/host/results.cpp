// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/host/results.h"

#include <stdexcept>
#include <unordered_map>

#include "host_api.h"
#include "parts/base/error.h"
#include "parts/host/layers.h"
#include "parts/mesh/slits.h"

namespace parts::host {

namespace {

using mesh::SurfaceFigures;

/// As the host will have it.
SurfaceFigures measured(const Mesh& mesh) {
  return mesh::measure_surface(sizeof(Scalarm) < sizeof(double) ? mesh::in_single_precision(mesh) : mesh);
}

/// Measures each layer of the document once.
class InputFigures {
 public:
  std::vector<SurfaceFigures> of(const std::vector<Layer>& layers) {
    return each(layers, figures_, [](const Mesh& mesh) { return measured(mesh); });
  }
  /// With the flaws that it has once vertices are welded where only rounding tells
  /// them apart: filters do so, which moves what was flawed before.
  std::vector<SurfaceFigures> also_without_slits(const std::vector<Layer>& layers) {
    std::vector<SurfaceFigures> all = of(layers);
    const auto known =
        each(layers, without_slits_, [](const Mesh& mesh) { return measured(mesh::prepare_without_slits(mesh)); });
    for (std::size_t i = 0; i < all.size(); ++i) mesh::add_flaws(known[i], all[i]);
    return all;
  }

 private:
  using Known = std::unordered_map<const MeshModel*, SurfaceFigures>;
  template <class Measure>
  static std::vector<SurfaceFigures> each(const std::vector<Layer>& layers, Known& known, const Measure& measure) {
    std::vector<SurfaceFigures> figures;
    for (const Layer& layer : layers) {
      const auto [it, fresh] = known.try_emplace(layer.model());
      if (fresh) it->second = measure(read_layer(*layer.model()));
      figures.push_back(it->second);
    }
    return figures;
  }
  Known figures_, without_slits_;
};

/// What is worse in a layer than in its inputs; empty where nothing is.
std::string worse_in(const Outcome::NewLayer& layer, const SurfaceFigures& whole, InputFigures& inputs) {
  const Outcome::Check& check = layer.check;
  const SurfaceFigures result =
      check.part.empty() ? whole : mesh::measure_parts(mesh::in_single_precision(layer.mesh), check.part);
  const std::string worse = mesh::worse_than_inputs(result, inputs.of(check.inputs), check.rules);
  if (worse.empty() || check.inputs.empty()) return worse;
  return mesh::worse_than_inputs(result, inputs.also_without_slits(check.inputs), check.rules);
}

void log_figures(const std::string& of, const SurfaceFigures& s, Progress& progress) {
  const std::pair<const char*, double> rows[] = {
      {"pieces", s.pieces},
      {"borders", s.borders},
      {"nonmanifold", double(s.nonmanifold.size())},
      {"pinches", double(s.pinches.size())},
      {"flipped", double(s.flipped.size())},
      {"crossings", double(s.crossings.size())},
  };
  for (const auto& [name, value] : rows) log_value(progress, (of + "_" + name).c_str(), value);
}

}  // namespace

void check_results(const Outcome& outcome, bool allow_flaws, Progress& progress) {
  for (const Outcome::Placement& p : outcome.placed)
    if (!p.matrix.allFinite()) throw std::logic_error("a matrix that is not finite");
  std::vector<std::string> flawed;
  InputFigures known;
  for (std::size_t i = 0; i < outcome.layers.size(); ++i) {
    const Outcome::NewLayer& layer = outcome.layers[i];
    progress.at(double(i) / double(outcome.layers.size()));
    mesh::check_arrays(layer.mesh);
    const bool current = int(i) == outcome.current;
    if (layer.check.as_it_is && !current) continue;
    const SurfaceFigures result = measured(layer.mesh);
    const bool made_of = !layer.check.inputs.empty();
    if (current) log_figures("result", result, progress);
    if (current && made_of) log_figures("input", mesh::together(known.of(layer.check.inputs)), progress);
    if (layer.check.as_it_is) continue;
    const std::string worse = worse_in(layer, result, known);
    if (!worse.empty())
      flawed.push_back("The result \"" + layer.name + "\" has " + worse +
                       (made_of ? ", which its inputs do not have" : ""));
  }
  if (flawed.empty()) return;
  if (!allow_flaws) throw UserError(flawed.back() + "; change the parameters, or set AllowFlaws to look at it.");
  for (const std::string& what : flawed) log_value(progress, "warning", what + "; look at it before you use it.");
}

}  // namespace parts::host
