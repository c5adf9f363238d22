#include <softkin/io/scene/silicones.hpp>

namespace softkin {

const char* silicone_curves_source() {
  return "tensile test to failure after ASTM D412, Marechal et al., Soft Robotics 2020, doi "
         "10.1089/soro.2019.0115";
}

// Constants in MPa, exponents without unit. Made by scripts/silicone_sets.py; do not edit by hand.
const std::vector<SiliconeSet>& silicone_sets() {
  static const std::vector<SiliconeSet> all{
      // begin of the table
      {"ecoflex-00-10", "yeoh", Law::yeoh, {0.0036696, 0.00012632, 1.0664e-08}, 2, 0.98},
      {"ecoflex-00-10", "ogden", Law::ogden, {0.0055928, 2.4935, 5.453e-07, 8.7485}, 2, 0.95},
      {"ecoflex-00-10", "mooney-rivlin", Law::mooney_rivlin, {0.0047828, -0.00026626}, 2, 5.3},
      {"ecoflex-00-10", "neo-hookean", Law::neo_hookean, {0.0093335}, 2, 5.5},
      {"ecoflex-00-30", "yeoh", Law::yeoh, {0.0077335, 0.00013915, -4.0616e-06}, 2, 0.79},
      {"ecoflex-00-30", "ogden", Law::ogden, {0.013183, 2.2751}, 2, 0.73},
      {"ecoflex-00-30", "mooney-rivlin", Law::mooney_rivlin, {0.0088139, -0.00049067}, 2, 2.3},
      {"ecoflex-00-30", "neo-hookean", Law::neo_hookean, {0.017205}, 2, 2.6},
      {"dragon-skin-10", "yeoh", Law::yeoh, {0.022193, 0.0028193, -9.0792e-05}, 2, 0.41},
      {"dragon-skin-10", "ogden", Law::ogden, {0.027039, 3.1313}, 2, 0.75},
      {"dragon-skin-10", "mooney-rivlin", Law::mooney_rivlin, {0.04031, -0.0022441}, 2, 8.7},
      {"dragon-skin-10", "neo-hookean", Law::neo_hookean, {0.078635}, 2, 9},
      {"dragon-skin-30", "yeoh", Law::yeoh, {0.094528, 0.0081509, -0.00027575}, 2, 0.44},
      {"dragon-skin-30", "ogden", Law::ogden, {0.12485, 2.8764}, 2, 0.55},
      {"dragon-skin-30", "mooney-rivlin", Law::mooney_rivlin, {0.14688, -0.0081767}, 2, 6.9},
      {"dragon-skin-30", "neo-hookean", Law::neo_hookean, {0.28657}, 2, 7.2},
      // end of the table
  };
  return all;
}

}  // namespace softkin
