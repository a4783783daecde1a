// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "host_api.h"
#include "parts/host/filter.h"

namespace parts::host {

/// Boxes of the layers that current_layer() and other_layer() propose.
Scene scene_of(const MeshDocument& document);

/// A filter's own parameters, and AllowFlaws where it makes a mesh.
std::vector<Parameter> parameters_of(const Filter& filter, const Scene& scene);

/// Adds the host's form of each parameter, with its default in this document.
void declare(const std::vector<Parameter>& parameters, const MeshDocument& document, RichParameterList& list);

/// Reads the host's values through the declarations that made them.
class RichInputs : public Inputs {
 public:
  /// @param list  may leave out some, which then have their defaults
  RichInputs(std::vector<Parameter> parameters, const RichParameterList& list, const MeshDocument& document);
  bool flag(const char* name) const override;
  int integer(const char* name) const override;
  double number(const char* name) const override;
  double length(const char* name) const override;
  int choice(const char* name) const override;
  Vec3 point(const char* name) const override;
  std::string text(const char* name) const override;
  Layer layer(const char* name) const override;
  std::optional<RasterLayer> raster() const override;

 private:
  const Parameter& declaration(const char* name) const;
  const Value& value(const char* name) const;
  template <class Given>
  Given of_type(const char* name, std::optional<Given> given) const;
  double in_range(const char* name, double value) const;
  double reach() const;

  std::vector<Parameter> parameters_;
  const RichParameterList& list_;
  RichParameterList defaults_;
  const MeshDocument& document_;
};

}  // namespace parts::host
