#include <softkin/io/scene/parts.hpp>
#include <softkin/model/layer.hpp>

namespace softkin::scene {

namespace {

void read_stiffness(const Map& map, LayerSpec& layer) {
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
  const Map map(node, {"name", "region", "surface", "unit", "thickness", "youngs_modulus", "poisson_ratio",
                       "orthotropic", "direction", "tension_only", "bending", "density"});
  auto layer = std::make_shared<LayerSpec>();
  layer->name = names.add_label(map.at("name"));
  layer->origin = node.origin;
  const Node::Entry& where = map.one_of({"region", "surface"});
  if (where.key == "region")
    layer->where = read_region_name(*where.value);
  else
    layer->where = read_surface_file(context, *where.value, map.find("unit"));
  layer->thickness_mm = read_positive_length(context, map.at("thickness"));
  read_stiffness(map, *layer);
  if (const Node* direction = map.find("direction")) {
    layer->direction = read_vector(*direction);
    if (layer->direction->isZero(0)) fail(*direction, direction->name + " must not be zero");
  }
  layer->tension_only = is_true(map, "tension_only");
  layer->bending = is_true(map, "bending");
  if (const Node* density = map.find("density")) layer->density = read_density(*density);
  return layer;
}

}  // namespace softkin::scene
