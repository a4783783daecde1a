// SPDX-License-Identifier: GPL-3.0-or-later
// Draws meshes side by side on a sheet: the pictures of the documentation.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "parts/base/error.h"
#include "parts/io/mesh_io.h"
#include "parts/io/raster_io.h"
#include "parts/render/camera.h"
#include "parts/render/rasterize.h"
#include "parts/render/surface_color.h"

namespace {

using namespace parts;

const char kUsage[] =
    "usage: picture OUT.png [options] MESH...\n"
    "Draws each mesh (.ply .obj .off .stl) from each view. A+B draws A and B in one\n"
    "cell, each in its own colour.\n"
    "  --views \"yaw,pitch; ...\"  degrees; yaw 90 is the model's left side (\"0,0\")\n"
    "  --up x,y,z  --front x,y,z  the models' axes (0,1,0 and 0,0,1)\n"
    "  --size N                   pixels a cell (480)\n"
    "  --cols N                   cells a row\n"
    "  --same-frame               one scale and place for all meshes\n"
    "  --zoom x,y,z,r             show the surroundings of a point, radius r\n"
    "  --flat | --smooth          light by face or smoothly (--smooth)\n"
    "  --plain                    grey, whatever the mesh's colours\n"
    "  --color-by-source          blue, red, yellow where the faces' quality is 0, 1, 2\n"
    "  --edges                    draw the edges of the faces\n"
    "  --mark-back                back faces in red\n"
    "  --label                    write the names below\n";

// Blue, red, yellow, green: told apart by most colour-blind readers.
const Color kPalette[] = {{92, 142, 196, 255}, {214, 102, 84, 255}, {232, 190, 84, 255}, {104, 168, 112, 255}};
constexpr int kOversampling = 3;

struct Arguments {
  std::string out, views = "0,0";
  std::vector<std::string> cells;
  Vec3 up{0, 1, 0}, front{0, 0, 1};
  int size = 480, columns = 0;
  bool same_frame = false, flat = false, plain = false, by_source = false, edges = false, mark_back = false;
  bool label = false;
  Box zoom;
};

std::vector<double> numbers(const std::string& name, const std::string& text, std::size_t n) {
  std::vector<double> values;
  const char* at = text.c_str();
  for (char* end; *at; at = *end == ',' ? end + 1 : end) {
    values.push_back(std::strtod(at, &end));
    if (end == at || (*end && *end != ',')) break;
  }
  if (values.size() != n || *at)
    throw UserError("The option " + name + " needs " + std::to_string(n) + " numbers with commas between them.");
  return values;
}

Vec3 vector_of(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

Arguments parse(int argc, char** argv) {
  Arguments a;
  const std::map<std::string, bool*> flags{{"--same-frame", &a.same_frame},
                                           {"--flat", &a.flat},
                                           {"--plain", &a.plain},
                                           {"--color-by-source", &a.by_source},
                                           {"--edges", &a.edges},
                                           {"--mark-back", &a.mark_back},
                                           {"--label", &a.label}};
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] {
      if (++i >= argc) throw UserError("The option " + word + " needs a value.");
      return std::string(argv[i]);
    };
    if (const auto flag = flags.find(word); flag != flags.end()) {
      *flag->second = true;
    } else if (word == "--smooth") {
      a.flat = false;
    } else if (word == "--views") {
      a.views = value();
    } else if (word == "--up") {
      a.up = vector_of(numbers(word, value(), 3));
    } else if (word == "--front") {
      a.front = vector_of(numbers(word, value(), 3));
    } else if (word == "--size") {
      a.size = int(std::clamp(numbers(word, value(), 1)[0], 16., 4000.));
    } else if (word == "--cols") {
      a.columns = int(std::clamp(numbers(word, value(), 1)[0], 1., 100.));
    } else if (word == "--zoom") {
      const std::vector<double> v = numbers(word, value(), 4);
      a.zoom = Box(vector_of(v) - Vec3::Constant(v[3]), vector_of(v) + Vec3::Constant(v[3]));
    } else if (word[0] == '-') {
      throw UserError("There is no option " + word + "; run picture without arguments to see them.");
    } else if (a.out.empty()) {
      a.out = word;
    } else {
      a.cells.push_back(word);
    }
  }
  return a;
}

/// What one cell shows.
struct Model {
  Mesh mesh;
  render::Textures textures;
  std::string label;
};

/// Smooth normals, across seams where vertices are doubled too.
void add_normals(Mesh& mesh) {
  std::map<std::array<double, 3>, Vec3> sum;
  const auto key = [](const Vec3& p) { return std::array<double, 3>{p.x(), p.y(), p.z()}; };
  std::vector<Vec3*> of_vertex;
  for (const Vec3& p : mesh.vertices)
    of_vertex.push_back(p.allFinite() ? &sum.try_emplace(key(p), 0, 0, 0).first->second : nullptr);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Vec3& p = mesh.corner(f, k);
      const Vec3 a = mesh.corner(f, (k + 1) % 3) - p, b = mesh.corner(f, (k + 2) % 3) - p, n = a.cross(b);
      const double length = n.norm();
      if (!(length > 0) || !std::isfinite(length) || !of_vertex[mesh.faces[f][k]]) continue;
      *of_vertex[mesh.faces[f][k]] += n / length * std::atan2(length, a.dot(b));  // weighted by the angle
    }
  mesh.vertex_normal.clear();
  for (const Vec3* n : of_vertex)
    mesh.vertex_normal.push_back(n ? Eigen::Vector3f(n->normalized().cast<float>()) : Eigen::Vector3f::Zero());
}

void color_by_source(Mesh& mesh) {
  mesh.face_color.resize(mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const float source = mesh.face_quality.empty() ? 0 : mesh.face_quality[f];
    mesh.face_color[f] = kPalette[source >= 0.5f ? source >= 1.5f ? 2 : 1 : 0];
  }
  mesh.vertex_color.clear();
  mesh.wedges.clear();
}

/// Adds a mesh in one colour.
void overlay(Mesh& all, const Mesh& mesh, const Color& color) {
  const int first = all.vertex_count();
  all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  all.vertex_normal.insert(all.vertex_normal.end(), mesh.vertex_normal.begin(), mesh.vertex_normal.end());
  for (const Triangle& t : mesh.faces) all.faces.push_back({t[0] + first, t[1] + first, t[2] + first});
  all.face_color.resize(all.faces.size(), color);
}

std::vector<std::string> files_of(const std::string& cell) {
  if (std::filesystem::exists(cell)) return {cell};
  std::vector<std::string> files(1);
  for (char c : cell)
    if (c == '+')
      files.emplace_back();
    else
      files.back() += c;
  return files;
}

Model load(const std::string& cell, const Arguments& a) {
  Model model;
  const std::vector<std::string> files = files_of(cell);
  for (std::size_t i = 0; i < files.size(); ++i) {
    Mesh mesh = io::read_mesh(files[i]);
    add_normals(mesh);
    model.label += (i ? " + " : "") + std::filesystem::path(files[i]).stem().string();
    if (files.size() > 1) {
      overlay(model.mesh, mesh, kPalette[i % 4]);
    } else {
      if (a.by_source) color_by_source(mesh);
      model.mesh = std::move(mesh);
    }
  }
  model.textures = render::load_textures(model.mesh);
  return model;
}

Box finite_bounds(const Mesh& mesh) {
  Box box;
  for (const Triangle& t : mesh.faces)
    for (int v : t)
      if (mesh.vertices[v].allFinite()) box.extend(mesh.vertices[v]);
  return box;
}

/// Moves and scales the camera to what it sees rather than to its box.
render::Camera framed(const Model& model, const Eigen::Matrix3d& rotation, const Arguments& a, const Box& common) {
  const int pixels = a.size * kOversampling;
  const Box box = finite_bounds(model.mesh);
  if (!a.zoom.isEmpty()) {
    render::Camera camera = render::orthographic_camera(rotation, a.zoom, pixels, pixels);
    camera.scale = pixels / a.zoom.sizes().x();
    camera.eye += rotation.row(2).transpose() * box.merged(a.zoom).diagonal().norm();
    return camera;
  }
  if (a.same_frame) return render::orthographic_camera(rotation, common, pixels, pixels);
  render::Camera camera = render::orthographic_camera(rotation, box, pixels, pixels);
  Eigen::AlignedBox2d seen;
  for (const Triangle& t : model.mesh.faces)
    for (int v : t)
      if (model.mesh.vertices[v].allFinite()) seen.extend(camera.project(model.mesh.vertices[v]).head<2>().eval());
  if (seen.isEmpty() || !(seen.sizes().maxCoeff() > 0)) return camera;
  const Eigen::Vector2d middle = seen.center();
  const double scale = 0.92 * pixels / seen.sizes().maxCoeff();
  camera.center = camera.center + scale * (camera.center - middle);
  camera.scale *= scale;
  return camera;
}

/// Darkens what lies deeper than its surroundings: the depth's difference from
/// its mean around (Luft et al., "Image Enhancement by Unsharp Masking the Depth
/// Buffer", 2006).
void deepen_creases(cv::Mat& image, const render::Rendering& seen, const render::Camera& camera) {
  const double reach = image.cols * 0.02;  // pixels
  cv::Mat inside, depth, mean, weight;
  seen.mask.convertTo(inside, CV_32F, 1 / 255.);
  depth = seen.depth.clone();
  depth.setTo(0, seen.mask == 0);
  cv::GaussianBlur(depth, mean, {}, reach);
  cv::GaussianBlur(inside, weight, {}, reach);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      if (!seen.mask.at<std::uint8_t>(y, x)) continue;
      const double deeper = depth.at<float>(y, x) - mean.at<float>(y, x) / weight.at<float>(y, x);
      const double shade = std::clamp(deeper * camera.scale / reach, -0.5, 1.5);
      image.at<cv::Vec3b>(y, x) *= 1 - 0.22 * shade * (shade > 0 ? 1 : 0.5);
    }
}

cv::Mat draw(const Model& model, const render::Camera& camera, const Arguments& a) {
  render::RenderOptions options;
  options.smooth = !a.flat;
  options.colors = !a.plain;
  options.base = {222, 224, 230, 255};
  options.light = {-0.4, 0.55, 0.85};
  options.ambient = 0.55;
  options.sky = 0.5;
  options.rim = 0.3;
  options.mark_back_faces = a.mark_back;
  options.edge_width = a.edges ? 0.35 * kOversampling : 0;
  render::Rendering large = render::render(model.mesh, model.textures, camera, options);
  deepen_creases(large.image, large, camera);
  cv::Mat image;
  cv::resize(large.image, image, cv::Size(a.size, a.size), 0, 0, cv::INTER_AREA);
  return image;
}

void write_label(cv::Mat& sheet, const std::string& text, const cv::Rect& strip) {
  const double scale = std::min(0.55, strip.width / 400.);
  int base = 0;
  const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &base);
  const cv::Point at(strip.x + std::max(0, (strip.width - size.width) / 2), strip.y + (strip.height + size.height) / 2);
  cv::putText(sheet, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(80, 80, 80), 1, cv::LINE_AA);
}

void run(const Arguments& a) {
  const std::vector<render::View> views = render::parse_views(a.views);
  std::vector<Model> models;
  Box common;
  for (const std::string& cell : a.cells) {
    models.push_back(load(cell, a));
    common.extend(finite_bounds(models.back().mesh));
  }
  const int cells = int(models.size() * views.size());
  const int columns = a.columns ? a.columns : views.size() > 1 ? int(views.size()) : std::min(cells, 4);
  const int rows = (cells + columns - 1) / columns, strip = a.label ? 28 : 0;
  cv::Mat sheet(rows * (a.size + strip), std::min(columns, cells) * a.size, CV_8UC3, cv::Scalar(255, 255, 255));
  for (int i = 0; i < cells; ++i) {
    const Model& model = models[i / views.size()];
    const Eigen::Matrix3d rotation = render::view_rotation(views[i % views.size()], a.up, a.front);
    const cv::Rect place(i % columns * a.size, i / columns * (a.size + strip), a.size, a.size);
    draw(model, framed(model, rotation, a, common), a).copyTo(sheet(place));
    if (a.label) write_label(sheet, model.label, {place.x, place.y + a.size, a.size, strip});
  }
  io::write_image(sheet, a.out);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Arguments arguments = parse(argc, argv);
    if (arguments.cells.empty()) {
      std::fputs(kUsage, stderr);
      return 2;
    }
    run(arguments);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "picture: %s\n", e.what());
    return 1;
  }
  return 0;
}
