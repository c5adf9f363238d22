#pragma once

#include <map>
#include <softkin/io/mesh/vtk.hpp>
#include <string>

#include "support/fnv.hpp"

namespace softkin::testing {

template <class Values>
std::string hash_of(const Values& values) {
  Fnv hash;
  for (const auto value : values) hash.add(value);
  return hash.text();
}

/// The lines of tests/io/read_shapes.py for a file with this content.
inline std::string hash_lines(const std::string& file, const VtuContent& content) {
  Fnv cells;
  for (std::size_t i = 0; i < content.tetrahedra.size(); ++i) {
    for (const Index v : content.tetrahedra[i]) cells.add(std::int64_t{v});
    for (std::size_t k = 0; !content.edge_nodes.empty() && k < content.edge_nodes[i].size(); ++k)
      cells.add(std::int64_t{content.edge_nodes[i][k]});
  }
  std::map<std::string, std::string> arrays;
  for (const std::vector<Field>* fields : {&content.point_fields, &content.cell_fields})
    for (const Field& field : *fields) arrays[field.name] = hash_of(field.values);
  if (!content.cell_regions.empty())
    arrays["region"] = hash_of(std::vector<std::int64_t>(content.cell_regions.begin(), content.cell_regions.end()));
  const Points& points = content.points;
  std::string lines = file + " mesh " + hash_of(std::vector<double>(points.data(), points.data() + points.size())) +
                      " " + cells.text() + "\n";
  for (const auto& [name, hash] : arrays) lines += file + " " + name + " " + hash + "\n";
  return lines;
}

}  // namespace softkin::testing
