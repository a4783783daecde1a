// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "parts/mend/region.h"
#include "parts/mesh/mesh.h"

namespace parts::bench {

/// A member of a class, whole.
struct Member {
  std::string file;
  Mesh mesh;                  ///< prepared, without textures
  std::vector<char> outer;    ///< per vertex: seen from outside; mouth, nostrils and eyes' backs are not
  Vec3 nose_tip, crown, ear;  ///< the left ear
  double unit = 1;            ///< world units: about the distance between the eyes
};

/// Objects of one kind.
struct MemberClass {
  std::string name;
  std::vector<Member> members;
  std::vector<std::string> models;  ///< files of another class that mend these; empty: the other members
};

/// The files of a folder with that ending (".obj"), sorted; none if it is not there.
std::vector<std::string> files_of(const std::string& folder, const std::string& extension);

/// The heads of the optional data; landmarks are in a file beside each. Empty if they are not there.
MemberClass heads(const std::string& data);
/// The head shapes; they have no landmarks: the nose's tip is the foremost
/// vertex beside the middle plane of the first, the crown its highest, and the
/// same vertices of the others.
MemberClass head_shapes(const std::string& data);
/// Members bent by a smooth random field of that RMS, in units: no face is
/// symmetric. Their models are the class as it was.
MemberClass bent(MemberClass members, double amount);
/// The real scan of a head; its models are the heads.
MemberClass head_scan(const std::string& data);
/// Busts of the project's own, written into a folder.
MemberClass busts(const std::string& folder, int count);

struct DamageCase {
  const char *name, *at;  ///< at: "nose", "crown" or "ear"
  Vec3 offset;            ///< of the centre from there, units; then the nearest point on the surface
  double radius;          ///< units
  enum Kind { Hole, Dent, Gouge, Noise } kind;
  bool box = false;  ///< given by a box (of a flaw, twice its size), not by its faces or those at the rim
};
extern const std::vector<DamageCase> kDamageCases;

struct Damaged {
  Mesh scan;
  mend::RegionOptions region;
  std::vector<Vec3> truth;  ///< the vertices that were removed or moved, as they were
  std::vector<char> outer;  ///< of these
};
Damaged damage(const Member& member, const DamageCase& what, unsigned seed);

}  // namespace parts::bench
