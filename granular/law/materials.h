// Materials by name, and the contact parameters of every pair of them (walls have materials too).
// A pair that is not given explicitly is mixed from the two materials' own values: stiffness as two springs in series
// (harmonic mean), E* and G* likewise, restitutions, friction and damping rates by the geometric mean (the default of
// LAMMPS GRANULAR), `own` by the mean. Equal materials give their own values, and a frictionless wall makes a
// frictionless pair.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "granular/law/law.h"

namespace granular {

class MaterialTable {
 public:
  /// Adds a material and returns its index. parameters: those of a contact with the same material. Throws InputError
  /// for an empty or a known name, or for parameters outside their range (the message names the material).
  int add(std::string_view name, const ContactParameters& parameters);

  /// Sets the parameters of one pair, either order. Throws InputError for an unknown name or a bad parameter.
  void setPair(std::string_view first, std::string_view second, const ContactParameters& parameters);

  /// Index of a name. Throws InputError naming the known ones.
  int find(std::string_view name) const;

  int count() const { return static_cast<int>(names.size()); }
  const std::string& name(int index) const { return names[static_cast<std::size_t>(index)]; }

  /// Constants of a contact between materials i and j; symmetric.
  const LawConstants& constants(int i, int j) const { return pairs[static_cast<std::size_t>(i * count() + j)]; }

 private:
  void write(int i, int j, const LawConstants& constants);

  std::vector<std::string> names;
  std::vector<ContactParameters> own;  // what mixing reads
  std::vector<LawConstants> pairs;     // count x count
};

/// The mixing rule of the table.
ContactParameters mixParameters(const ContactParameters& a, const ContactParameters& b);

}  // namespace granular
