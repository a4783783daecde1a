// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/rivals.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "parts/io/mesh_io.h"

namespace parts::bench {
namespace {

Mesh by_meshlab(const Mesh& scan, const std::string& folder, const std::string& name, const std::string& filter) {
  std::filesystem::create_directories(folder);
  const std::filesystem::path base = std::filesystem::path(folder) / name;
  const std::string in = base.string() + "_in.ply", out = base.string() + "_out.ply", mlx = base.string() + ".mlx";
  io::write_mesh(scan, in);
  std::ofstream(mlx) << "<!DOCTYPE FilterScript>\n<FilterScript>\n" << filter << "</FilterScript>\n";
  std::filesystem::remove(out);
  const std::string command = "cd '" + folder +
                              "' && timeout 120 '" SOURCE_DIR "/tools/headless' '" STAGE "/bin/meshlabserver' -i '" +
                              in + "' -o '" + out + "' -s '" + mlx + "' >'" + base.string() + ".log' 2>&1";
  if (std::system(command.c_str()) != 0 || !std::filesystem::exists(out))
    throw std::runtime_error(name + " failed, see " + base.string() + ".log");
  return io::read_mesh(out);
}

std::string param(const char* type, const char* name, const char* value) {
  return std::string("  <Param type=\"") + type + "\" name=\"" + name + "\" value=\"" + value + "\"/>\n";
}

}  // namespace

Mesh close_holes(const Mesh& scan, const std::string& folder) {
  return by_meshlab(scan, folder, "close_holes",
                    " <filter name=\"Close Holes\">\n" + param("RichInt", "MaxHoleSize", "1000000") +
                        param("RichBool", "Selected", "false") + param("RichBool", "NewFaceSelected", "true") +
                        param("RichBool", "SelfIntersection", "true") + " </filter>\n");
}

Mesh screened_poisson(const Mesh& scan, const std::string& folder) {
  return by_meshlab(
      scan, folder, "poisson",
      " <filter name=\"Surface Reconstruction: Screened Poisson\">\n" + param("RichBool", "visibleLayer", "false") +
          param("RichInt", "depth", "8") + param("RichInt", "fullDepth", "5") + param("RichInt", "cgDepth", "0") +
          param("RichFloat", "scale", "1.1") + param("RichFloat", "samplesPerNode", "1.5") +
          param("RichFloat", "pointWeight", "4") + param("RichInt", "iters", "8") +
          param("RichBool", "confidence", "false") + param("RichBool", "preClean", "false") + " </filter>\n");
}

}  // namespace parts::bench
