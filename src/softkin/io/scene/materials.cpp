#include <algorithm>
#include <softkin/io/scene/parts.hpp>
#include <softkin/io/scene/silicones.hpp>

namespace softkin::scene {

namespace {

/// A law as scenes name it, and the constants that it takes.
struct LawKeys {
  Law law;
  const char* name;
  Keys required, optional;
  bool needs_bulk;  // exactly one of bulk_modulus and poisson_ratio
};

const Keys elastic_keys{"law", "youngs_modulus", "poisson_ratio", "c10", "c01", "c20", "c30", "bulk_modulus",
                        "jm",  "shear_modulus"};

const std::vector<LawKeys>& laws() {
  const Keys moduli{"youngs_modulus", "poisson_ratio"}, bulk{"bulk_modulus", "poisson_ratio"};
  static const std::vector<LawKeys> all{{Law::st_venant_kirchhoff, "st-venant-kirchhoff", moduli, {}, false},
                                        {Law::corotational, "corotational", moduli, {}, false},
                                        {Law::neo_hookean, "neo-hookean", moduli, {}, false},
                                        {Law::mooney_rivlin, "mooney-rivlin", {"c10"}, {"c01", bulk[0], bulk[1]}, true},
                                        {Law::yeoh, "yeoh", {"c10"}, {"c20", "c30", bulk[0], bulk[1]}, true},
                                        {Law::gent, "gent", {"shear_modulus", "jm"}, bulk, true}};
  return all;
}

bool holds(const Keys& keys, const std::string& key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

const LawKeys& read_law(const Map& map) {
  Keys names;
  for (const LawKeys& law : laws()) names.push_back(law.name);
  if (const Node* node = map.find("law")) return laws()[choice(*node, names)];
  return *std::find_if(laws().begin(), laws().end(), [](const LawKeys& law) { return law.law == ElasticSpec().law; });
}

/// Fails where a constant is there that the law does not take, or one is missing that it needs.
void check_constants(const Map& map, const LawKeys& law) {
  const std::string name = std::string("law '") + law.name + "'" + (map.find("law") ? "" : " (the default)");
  for (const std::string& key : elastic_keys) {
    const Node::Entry* entry = map.entry(key);
    if (entry && key != "law" && !holds(law.required, key) && !holds(law.optional, key))
      throw InvalidInput(entry->origin, "key '" + key + "' does not belong to " + name + ", which takes " +
                                            joined(law.required) + (law.optional.empty() ? "" : ", ") +
                                            joined(law.optional));
  }
  for (const std::string& key : law.required)
    if (!map.find(key)) fail(map.node(), map.node().name + ": " + name + " needs key '" + key + "'");
  if (law.needs_bulk) (void)map.one_of({"bulk_modulus", "poisson_ratio"});
}

double read_poisson_ratio(const Node& node, Law law) {
  const double ratio = number(node);
  if (ratio == 0.5 && !has_bulk_part(law))
    fail(node, node.name +
                   " is 0.5, which keeps the volume: take 'law: neo-hookean', 'mooney-rivlin', 'yeoh' or "
                   "'gent', which have a part for that, or 0.49");
  if (!(ratio > -1 && ratio <= 0.5))
    fail(node, node.name + " must be greater than -1 and at most 0.5, not " + node.text);
  return ratio;
}

/// The coefficient; 0 where the law takes it and it is absent.
std::optional<double> read_coefficient(const Map& map, const LawKeys& law, const std::string& key) {
  if (!holds(law.required, key) && !holds(law.optional, key)) return std::nullopt;
  const Node* node = map.find(key);
  return node ? number(*node) : 0;
}

/// Of a silicone by its name.
ElasticSpec read_named(const Map& map, const Silicone& named) {
  for (const std::string& key : elastic_keys)
    if (const Node::Entry* entry = map.entry(key); entry && key != "poisson_ratio")
      throw InvalidInput(entry->origin, "key '" + key + "' does not go with 'material', which has the constants of " +
                                            named.name + ": 'poisson_ratio' and 'density' may stand beside it");
  const Node* ratio = map.find("poisson_ratio");
  return ratio ? named.elastic(read_poisson_ratio(*ratio, Law::neo_hookean)) : named.elastic();
}

std::optional<ElasticSpec> read_elastic(const Map& map) {
  if (std::none_of(elastic_keys.begin(), elastic_keys.end(), [&](const std::string& key) { return map.entry(key); }))
    return std::nullopt;
  const LawKeys& law = read_law(map);
  check_constants(map, law);
  ElasticSpec elastic;
  elastic.law = law.law;
  if (const Node* node = map.find("youngs_modulus")) elastic.youngs_modulus = positive(*node);
  if (const Node* node = map.find("poisson_ratio")) elastic.poisson_ratio = read_poisson_ratio(*node, law.law);
  if (const Node* node = map.find("bulk_modulus")) elastic.bulk_modulus = positive(*node);
  if (const Node* node = map.find("shear_modulus")) elastic.shear_modulus = positive(*node);
  if (const Node* node = map.find("jm")) elastic.jm = positive(*node);
  elastic.c10 = read_coefficient(map, law, "c10");
  elastic.c01 = read_coefficient(map, law, "c01");
  elastic.c20 = read_coefficient(map, law, "c20");
  elastic.c30 = read_coefficient(map, law, "c30");
  // the shear modulus at small strain is twice this sum
  if (elastic.c10 && !(*elastic.c10 + elastic.c01.value_or(0) > 0))
    fail(map.at("c10"), std::string(elastic.c01 ? "'c10' + 'c01'" : "'c10'") + " must be greater than 0");
  return elastic;
}

std::optional<double> read_shape_ratio(const Map& map) {
  const Node* node = map.find("shape_ratio");
  if (!node) return std::nullopt;
  const double ratio = number(*node);
  if (ratio < 0 || ratio > 1) fail(*node, "'shape_ratio' must be from 0 to 1, not " + node->text);
  return ratio;
}

/// Maxwell branches.
std::vector<ViscousBranch> read_viscosity(const Node& node) {
  std::vector<ViscousBranch> branches;
  for (const auto& item : list(node)) {
    const Map map(*item, {"modulus", "time"});
    branches.push_back({positive(map.at("modulus")), positive(map.at("time"))});
  }
  return branches;
}

double read_permittivity(const Node& node) {
  const double permittivity = number(node);
  if (!(permittivity >= 1))
    fail(node, node.name + " is over that of the vacuum and must be 1 or more, not " + node.text);
  return permittivity;
}

}  // namespace

double read_density(const Node& node) {
  const double density = number(node);
  if (density < 0) fail(node, node.name + " must not be negative: " + node.text);
  return density;
}

MaterialSpec read_material(const Context& context, const Node& node) {
  Keys known{"region",       "shape_ratio", "weight",        "linear_range", "density",  "viscosity",
             "permittivity", "remanence",   "magnetisation", "material",     "elements", "families"};
  known.insert(known.end(), elastic_keys.begin(), elastic_keys.end());
  const Map map(node, known);
  MaterialSpec material;
  material.origin = node.origin;
  const Node* region = map.find("region");
  material.region = region ? text(*region) : "all";
  material.shape_ratio = read_shape_ratio(map);
  const Node* name = map.find("material");
  const Silicone* named = name ? &silicone(text(*name), name->origin) : nullptr;
  material.elastic = named ? read_named(map, *named) : read_elastic(map);
  if (named) material.density = named->density;
  if (!material.shape_ratio && !material.elastic)
    fail(node, node.name +
                   " needs 'shape_ratio' (target-shape) or elastic constants (physical), such as 'youngs_modulus' and "
                   "'poisson_ratio', or 'material: ecoflex-00-30'");
  if (const Node* weight = map.find("weight")) material.weight = positive(*weight);
  if (const Node* density = map.find("density")) material.density = read_density(*density);
  if (const Node* viscosity = map.find("viscosity")) material.viscosity = read_viscosity(*viscosity);
  if (const Node* value = map.find("permittivity")) material.permittivity = read_permittivity(*value);
  material.remanence = read_remanence(context, map);
  material.families = read_families(context, map);
  if (const Node* range = map.find("linear_range")) material.linear_range = positive(*range);
  if (const Node* elements = map.find("elements")) material.mixed = choice(*elements, {"plain", "mixed"}) == 1;
  return material;
}

}  // namespace softkin::scene
