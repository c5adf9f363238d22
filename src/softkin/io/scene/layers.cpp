#include <algorithm>
#include <softkin/io/scene/parts.hpp>
#include <softkin/model/layer.hpp>

namespace softkin::scene {

namespace {

const Keys constants_of_laws{"shear_modulus", "c10", "c01", "c20", "c30"};
const Keys rubber_laws{"neo-hookean", "mooney-rivlin", "yeoh"};

/// Of a skin of rubber, which keeps its volume.
SheetRubber read_rubber(const Map& map, const Node& law) {
  const Keys& names = rubber_laws;
  const Keys moduli{"youngs_modulus", "shear_modulus"};
  const std::vector<Keys> taken{moduli, {"c10", "c01"}, {"c10", "c20", "c30"}};
  const std::size_t which = choice(law, names);
  for (const std::string& key : Keys{"youngs_modulus", "shear_modulus", "c10", "c01", "c20", "c30", "orthotropic"})
    if (const Node* found = map.find(key);
        found != nullptr && std::find(taken[which].begin(), taken[which].end(), key) == taken[which].end())
      fail(*found, "'" + key + "' does not belong to law '" + names[which] + "'");
  if (const Node* ratio = map.find("poisson_ratio"); ratio != nullptr && number(*ratio) != 0.5)
    fail(*ratio, "a skin of a rubber law keeps its volume: 'poisson_ratio' is 0.5, or left out");
  if (which == 0) {
    const Node::Entry& given = map.one_of(moduli);
    return {positive(*given.value) / (given.key == "youngs_modulus" ? 6 : 2), 0, 0, 0};
  }
  const auto constant = [&](const char* key) {
    const Node* found = map.find(key);
    return found == nullptr ? 0.0 : number(*found);
  };
  const double c10 = number(map.at("c10")), c01 = which == 1 ? number(map.at("c01")) : 0;
  const SheetRubber rubber{c10, c01, constant("c20"), constant("c30")};
  if (!(rubber.c10 + rubber.c01 > 0)) fail(map.at("c10"), "'c10' + 'c01' must be greater than 0");
  if (rubber.c01 < 0) fail(map.at("c01"), "'c01' must be 0 or more");
  return rubber;
}

void read_stiffness(const Map& map, LayerSpec& layer) {
  if (const Node* law = map.find("law")) {
    layer.rubber = read_rubber(map, *law);
    return;
  }
  for (const std::string& key : constants_of_laws)
    if (const Node* found = map.find(key)) fail(*found, "'" + key + "' is of a 'law'; name it");
  const Node::Entry& given = map.one_of({"youngs_modulus", "orthotropic"});
  const Node* ratio = map.find("poisson_ratio");
  if (given.key == "youngs_modulus") {
    layer.e1 = layer.e2 = positive(*given.value);
    layer.nu12 = number(map.at("poisson_ratio"));
    if (!(layer.nu12 > -1 && layer.nu12 <= 0.5))
      fail(*ratio, "'poisson_ratio' must be above -1 and at most 0.5, not " + ratio->text);
    layer.g12 = layer.e1 / (2 * (1 + layer.nu12));
    return;
  }
  if (ratio != nullptr) fail(*ratio, "'poisson_ratio' is of 'youngs_modulus': 'orthotropic' has 'nu12'");
  const Map constants(*given.value, {"e1", "e2", "g12", "nu12"});
  layer.e1 = positive(constants.at("e1"));
  layer.e2 = positive(constants.at("e2"));
  layer.g12 = positive(constants.at("g12"));
  layer.nu12 = number(constants.at("nu12"));
  if (map.find("direction") == nullptr) fail(*given.value, "an orthotropic layer needs its 'direction', that of e1");
}

}  // namespace

std::shared_ptr<const LayerSpec> read_layer(const Context& context, const Node& node, Names& names) {
  check_choice(node, "law", rubber_laws);
  const Map map(node, {"name", "region", "surface", "unit", "thickness", "law", "youngs_modulus", "poisson_ratio",
                       "shear_modulus", "c10", "c01", "c20", "c30", "orthotropic", "direction", "tension_only",
                       "bending", "density"});
  auto layer = std::make_shared<LayerSpec>();
  layer->name = names.add_label(map.at("name"));
  layer->origin = node.origin;
  const Node::Entry& where = map.one_of({"region", "surface"});
  if (where.key == "region")
    layer->where = read_region_name(*where.value);
  else
    layer->where = where.value->kind == Node::Kind::map ? read_surface(context, *where.value)
                                                        : read_surface_file(context, *where.value, map.find("unit"));
  layer->thickness_mm = read_positive_length(context, map.at("thickness"));
  read_stiffness(map, *layer);
  if (const Node* direction = map.find("direction")) {
    layer->direction = read_vector(*direction);
    if (layer->direction->isZero(0)) fail(*direction, direction->name + " must not be zero");
  }
  layer->tension_only = is_true(map, "tension_only");
  layer->bending = is_true(map, "bending");
  if (layer->bending && layer->rubber)
    fail(map.at("bending"), "a skin of a rubber law does not bend: 'bending' takes 'youngs_modulus' or 'orthotropic'");
  if (const Node* density = map.find("density")) layer->density = read_density(*density);
  return layer;
}

}  // namespace softkin::scene
