// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/base/progress.h"
#include "parts/mend/blend.h"
#include "parts/mend/fit_to_rim.h"
#include "parts/mend/region.h"

namespace parts::mend {

/// What mends a scan: a model in the scan's place and size, as the search left it.
struct PlacedModel {
  Mesh mesh;
  std::string name;
};

struct FittingOptions {
  bool refine = true;       ///< ICP on the surface around the region, before anything else
  bool allow_scale = true;  ///< the ICP may change the model's size
  bool fit_to_rim = true;   ///< bend the model onto the scan around the region; false: as it is (thesis)
  int blend = 16;           ///< how many of the models are blended, at most; 1 = the base alone
  int threads = 0;          ///< 0 = all cores; the result does not depend on it
};

/// What is pasted into the scan.
struct Fit {
  int model = -1;
  Mesh mesh;
  Fitted fitted;  ///< without its vertices, which the mesh has
  int blended = 1;
};

/// How far around a region models and scan are compared, of its size.
constexpr double kAround = 0.8;
/// The box of a region grown by that share of its size.
Box around(const Region& region, double share);

/// Brings models onto the surface around a region: each rigidly, then smoothly;
/// then blends them. Each is brought once, when it is first needed.
class ModelFitter {
 public:
  /// All are kept by reference.
  ModelFitter(const std::vector<PlacedModel>& models, const Region& region, const FitTarget& target,
              const FittingOptions& options)
      : models_(models), region_(region), target_(target), options_(options), brought_(models.size()) {}

  /// With that model as the base. Its mesh has no face if the model has none near the region.
  /// @throws Cancelled
  Fit operator()(int model, Progress& progress);

 private:
  struct Brought {
    bool done = false;
    PosedModel posed;
    Fitted fitted;  ///< without its vertices, which posed has
    bool fits() const { return fitted.share > 0.6 && !posed.mesh.faces.empty(); }
  };
  bool blends() const { return options_.fit_to_rim && options_.blend > 1; }
  void bring(int model);
  void bring_first(int count, Progress& progress);
  void blend(Fit& fit, Progress& progress);

  const std::vector<PlacedModel>& models_;
  const Region& region_;
  const FitTarget& target_;
  const FittingOptions& options_;
  std::vector<Brought> brought_;  ///< of each model
};

}  // namespace parts::mend
