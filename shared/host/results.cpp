// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts/host/results.h"

#include <stdexcept>
#include <unordered_map>

#include "host_api.h"
#include "parts/base/error.h"
#include "parts/host/layers.h"

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
  const SurfaceFigures& of(const Layer& layer) {
    const auto [it, fresh] = figures_.try_emplace(layer.model());
    if (fresh) it->second = measured(read_layer(*layer.model()));
    return it->second;
  }

 private:
  std::unordered_map<const MeshModel*, SurfaceFigures> figures_;
};

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
    std::vector<SurfaceFigures> inputs;
    for (const Layer& input : layer.check.inputs) inputs.push_back(known.of(input));
    if (current) log_figures("result", result, progress);
    if (current && !inputs.empty()) log_figures("input", mesh::together(inputs), progress);
    if (layer.check.as_it_is) continue;
    const std::string worse = mesh::worse_than_inputs(result, inputs, layer.check.rules);
    if (!worse.empty())
      flawed.push_back("The result \"" + layer.name + "\" has " + worse +
                       (inputs.empty() ? "" : ", which its inputs do not have"));
  }
  if (flawed.empty()) return;
  if (!allow_flaws) throw UserError(flawed.back() + "; change the parameters, or set AllowFlaws to look at it.");
  for (const std::string& what : flawed) log_value(progress, "warning", what + "; look at it before you use it.");
}

}  // namespace parts::host
