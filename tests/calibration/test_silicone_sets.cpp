#include <gtest/gtest.h>

#include <softkin/calibration/tensile_fit.hpp>
#include <softkin/core/elastic_stability.hpp>
#include <softkin/io/scene/silicones.hpp>
#include <softkin/model/compile/parts.hpp>

namespace softkin {

/// All sets of a curve have about the stress of that curve at a strain of 1, and are stable where they were fitted.
TEST(SiliconeSets, AgreeWithEachOtherAndAreStable) {
  std::size_t compared = 0;
  for (const Silicone& silicone : silicones()) {
    double reference = 0;
    for (const std::string& set : silicone.sets()) {
      if (set == Silicone::default_set) continue;
      const ElasticLaw law = elastic_law(silicone.elastic(set, 0.4999, {}), "it", {});
      const double stress = calibration::uniaxial_stress(law, 1);
      if (reference == 0) reference = stress;
      EXPECT_NEAR(stress / reference, 1, 0.25) << silicone.name << " " << set;
      EXPECT_FALSE(stability_limit(law, 2.95)) << silicone.name << " " << set;
      EXPECT_NE(silicone.named(set, 0.49).source.find("10.1089/soro.2019.0115"), std::string::npos);
      ++compared;
    }
    EXPECT_EQ(silicone.named(Silicone::default_set, 0.49).sets.size(), silicone.sets().size());
  }
  EXPECT_EQ(compared, 16u);
  for (const SiliconeSet& set : silicone_sets()) EXPECT_GT(set.rms_percent, 0);
}

/// What the measured curves have at a strain of 1 (0.437 and 0.113 MPa), by their own tables.
TEST(SiliconeSets, FollowTheCurves) {
  const auto stress = [](const char* name, const char* set) {
    return calibration::uniaxial_stress(elastic_law(silicone(name, {}).elastic(set, 0.4999, {}), "it", {}), 1);
  };
  for (const char* set : {"yeoh", "ogden"}) {
    EXPECT_NEAR(stress("dragon-skin-30", set), 0.437, 0.02);
    EXPECT_NEAR(stress("dragon-skin-10", set), 0.113, 0.006);
    EXPECT_NEAR(stress("ecoflex-00-30", set), 0.0297, 0.0015);
    EXPECT_NEAR(stress("ecoflex-00-10", set), 0.0148, 0.001);
  }
}

}  // namespace softkin
