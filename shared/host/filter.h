// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "parts/base/files.h"
#include "parts/base/progress.h"
#include "parts/mesh/mesh.h"
#include "parts/mesh/result_check.h"
#include "parts/render/camera.h"

class MeshModel;  // the host's layer

/// What a plugin folder writes, in plain types: a table of filters, each with
/// its parameters and one function from inputs to an outcome. The rest of this
/// folder turns the table into a plugin of the host and commits the outcome.
namespace parts::host {

/// A layer of the host's document.
class Layer {
 public:
  explicit Layer(MeshModel* model) : model_(model) {}
  std::string name() const;
  Mesh mesh() const;  ///< a copy in world space
  MeshModel* model() const { return model_; }
  bool operator==(const Layer& other) const { return model_ == other.model_; }

 private:
  MeshModel* model_;
};

/// A raster layer of the host's document: a registered image.
struct RasterLayer {
  std::string name;
  std::string file;                      ///< of its first plane, absolute
  std::optional<render::Camera> camera;  ///< where it has one that can be used
};

/// A parameter as users and scripts see it. Made by the functions below.
struct Parameter {
  enum class Kind { Flag, Integer, Number, Length, Choice, Point, Text, OpenFile, SaveFile, CurrentLayer, OtherLayer };
  Kind kind;
  std::string name;                                    ///< in scripts; never changes
  std::string label;                                   ///< in the dialog
  std::string help;                                    ///< tooltip
  double value = 0;                                    ///< default of Flag, Integer, Number, Length and Choice
  double min = std::numeric_limits<double>::lowest();  ///< what the filter accepts
  double max = std::numeric_limits<double>::max();
  Vec3 point = Vec3::Zero();        ///< default of Point
  std::string text;                 ///< default of Text and the files
  std::vector<std::string> values;  ///< of Choice; of files their extensions, "ply"
};

Parameter flag(std::string name, bool value, std::string label, std::string help);
Parameter integer(std::string name, int value, int min, int max, std::string label, std::string help);
Parameter number(std::string name, double value, double min, double max, std::string label, std::string help);
/// World units, not negative; the dialog offers percents of the diagonal of the visible layers too.
Parameter length(std::string name, double value, std::string label, std::string help);
Parameter choice(std::string name, int value, std::vector<std::string> values, std::string label, std::string help);
Parameter point(std::string name, const Vec3& value, std::string label, std::string help);
Parameter text(std::string name, std::string value, std::string label, std::string help);
/// @param endings  of the files to choose from, without the dot
Parameter open_file(std::string name, std::vector<std::string> endings, std::string label, std::string help);
/// @param ending  that the dialog proposes, without the dot
Parameter save_file(std::string name, std::string ending, std::string label, std::string help);
Parameter current_layer(std::string name, std::string label, std::string help);
Parameter other_layer(std::string name, std::string label, std::string help);

/// What the defaults of parameters may depend on: boxes of layers, world
/// space, empty where there is none.
struct Scene {
  Box current;  ///< the current layer
  Box other;    ///< the layer that other_layer() proposes
};

/// The values that the user gave. A value of the wrong type, not finite or out
/// of the parameter's range throws a UserError that names the parameter.
class Inputs {
 public:
  virtual ~Inputs() = default;
  virtual bool flag(const char* name) const = 0;
  virtual int integer(const char* name) const = 0;
  virtual double number(const char* name) const = 0;
  virtual double length(const char* name) const = 0;
  virtual int choice(const char* name) const = 0;
  virtual Vec3 point(const char* name) const = 0;
  virtual std::string text(const char* name) const = 0;  ///< Text and the files
  virtual Layer layer(const char* name) const = 0;
  /// The current raster layer; nothing where there is none or it has no file.
  virtual std::optional<RasterLayer> raster() const = 0;
};

/// What a filter wants done to the document. Nothing is done before the filter
/// has returned, so a failed or cancelled one leaves the document as it was.
struct Outcome {
  /// What the host compares a new layer with before it is added.
  struct Check {
    std::vector<Layer> inputs = {};  ///< whose surfaces it is made of; none: it is to have no flaw at all
    mesh::ResultRules rules = {};
    bool as_it_is = false;  ///< a model that was not made here: its flaws are its own
    /// Per face, where parts lie beside each other that may cross and touch: which it is of.
    std::vector<char> part = {};
  };
  struct NewLayer {
    std::string name;
    Mesh mesh;
    bool visible = true;
    std::optional<render::Camera> camera = {};  ///< through which its image was seen
    Check check = {};
  };
  struct NewRaster {
    std::string name;
    std::string file;  ///< of the image
    render::Camera camera;
    double distance;  ///< of what it shows, world units; see to_mlp()
  };
  struct Placement {
    Layer layer;
    Eigen::Matrix4d matrix;    ///< applied after the layer's own matrix
    bool to_vertices = false;  ///< into the coordinates, and the layer's matrix becomes the identity
  };
  std::vector<NewLayer> layers;    ///< added in this order
  std::vector<NewRaster> rasters;  ///< the last one becomes the current raster
  int current = -1;                ///< of layers: becomes the current one
  std::vector<Layer> hidden;       ///< a result replaces them on the screen
  std::vector<Placement> placed;
  /// Written as drafts by the filter; put in place once the layers have been
  /// checked and added, so that a result that is refused leaves no file either.
  std::shared_ptr<OutputFiles> files = std::make_shared<OutputFiles>();
};

/// The menus that the suite's filters appear in. Creation: needs no layer.
enum class Menu { Remeshing, Deformation, Placement, Texturing, Creation };

struct Filter {
  std::string name;  ///< "Group: Action"; never changes
  std::string slug;  ///< of scripts/<slug>.mlx
  Menu menu;
  std::string help;  ///< HTML
  std::function<std::vector<Parameter>(const Scene&)> parameters;
  std::function<Outcome(const Inputs&, Progress&)> apply;
  bool makes_mesh = true;  ///< gets the parameter AllowFlaws
};

/// The filters of the plugin that is being built; each plugin folder defines it.
std::vector<Filter> filters();

/// Logs a measured figure as "name: value".
void log_value(Progress& progress, const char* name, double value);
void log_value(Progress& progress, const char* name, const std::string& value);

}  // namespace parts::host
