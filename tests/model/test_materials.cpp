#include <gtest/gtest.h>

#include <cmath>
#include <softkin/model/compile/parts.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

ElasticLaw compiled(const ElasticSpec& elastic) {
  RobotSpec spec = physical_robot(block_mesh({1, 1, 1}, {1, 1, 1}));
  spec.materials[0].elastic = elastic;
  return compile(spec).elements.materials[0].elastic;
}

TEST(ElasticConstants, YoungsModulusAndPoissonRatio) {
  for (const Law law : {Law::st_venant_kirchhoff, Law::corotational, Law::neo_hookean})
    for (const double nu : {-0.5, 0.0, 0.3, 0.49}) {
      ElasticSpec spec;
      spec.law = law;
      spec.youngs_modulus = 2.5;
      spec.poisson_ratio = nu;
      const ElasticLaw elastic = compiled(spec);
      EXPECT_EQ(elastic.law, law);
      // under uniaxial stress E e the strains are (e, -nu e, -nu e), by Hooke's law in mu and lambda
      const double trace = 1 - 2 * nu;
      EXPECT_NEAR(2 * elastic.mu + elastic.lambda * trace, 2.5, 1e-12);
      EXPECT_NEAR(-2 * elastic.mu * nu + elastic.lambda * trace, 0, 1e-12);
      EXPECT_EQ(elastic.c10, 0);
      EXPECT_EQ(elastic.bulk, 0);
    }
}

TEST(ElasticConstants, BulkModulusGivenOrByPoissonRatio) {
  ElasticSpec rivlin;
  rivlin.law = Law::mooney_rivlin;
  rivlin.c10 = 0.4;
  rivlin.c01 = -0.1;
  rivlin.bulk_modulus = 30;
  ElasticLaw law = compiled(rivlin);
  EXPECT_EQ(law.c10, 0.4);
  EXPECT_EQ(law.c01, -0.1);
  EXPECT_EQ(law.bulk, 30);
  EXPECT_EQ(law.mu, 0);
  rivlin.bulk_modulus.reset();
  rivlin.poisson_ratio = 0.45;
  law = compiled(rivlin);
  // nu = (3 K - 2 G) / (2 (3 K + G)), G = 0.6
  EXPECT_NEAR((3 * law.bulk - 1.2) / (2 * (3 * law.bulk + 0.6)), 0.45, 1e-14);

  ElasticSpec yeoh;
  yeoh.law = Law::yeoh;
  yeoh.c10 = 0.3;
  yeoh.c20 = -0.01;
  yeoh.poisson_ratio = 0.45;
  const ElasticLaw same = compiled(yeoh);
  EXPECT_NEAR(same.bulk, law.bulk, 1e-12);
  EXPECT_EQ(same.c20, -0.01);
  EXPECT_EQ(same.c30, 0);
}

TEST(ElasticConstants, OfALimitedStretch) {
  ElasticSpec gent;
  gent.law = Law::gent;
  gent.shear_modulus = 0.6;
  gent.jm = 40;
  gent.poisson_ratio = 0.45;
  const ElasticLaw law = compiled(gent);
  EXPECT_EQ(law.mu, 0.6);
  EXPECT_EQ(law.jm, 40);
  EXPECT_EQ(law.c10, 0);
  EXPECT_NEAR((3 * law.bulk - 1.2) / (2 * (3 * law.bulk + 0.6)), 0.45, 1e-14);
  const StiffnessAtRest rest = stiffness_at_rest(law);
  EXPECT_NEAR(rest.youngs_modulus_MPa, 2 * 0.6 * 1.45, 1e-12);
  EXPECT_NEAR(rest.poisson_ratio, 0.45, 1e-12);
}

TEST(ElasticConstants, OfOgdensTerms) {
  ElasticSpec ogden;
  ogden.law = Law::ogden;
  ogden.ogden = {{0.5, 2}, {-0.1, -3}};
  ogden.poisson_ratio = 0.45;
  const ElasticLaw law = compiled(ogden);
  constexpr double shear = (0.5 * 2 + 0.1 * 3) / 2;
  EXPECT_EQ(law.ogden[1].alpha, -3);
  EXPECT_EQ(law.ogden[2].alpha, 0);
  EXPECT_NEAR(stiffness_at_rest(law).youngs_modulus_MPa, 2 * shear * 1.45, 1e-12);
  EXPECT_NEAR(stiffness_at_rest(law).poisson_ratio, 0.45, 1e-12);
  const auto refused = [&](const std::vector<OgdenTerm>& terms) {
    ElasticSpec wrong = ogden;
    wrong.ogden = terms;
    EXPECT_THROW((void)compiled(wrong), InvalidInput);
  };
  refused({});
  refused({{1, 0}});
  refused({{1, -2}});
  refused({{1, 2}, {1, 2}, {1, 2}, {1, 2}});
  refused({{std::nan(""), 2}});
  ElasticSpec foreign = ogden;
  foreign.c10 = 1;
  EXPECT_THROW((void)compiled(foreign), InvalidInput);
}

TEST(ElasticConstants, WarnOfALawThatLosesItsStability) {
  RobotSpec spec = physical_robot(block_mesh({1, 1, 1}, {1, 1, 1}));
  const auto warns = [&](const ElasticSpec& elastic) {
    spec.materials[0].elastic = elastic;
    for (const std::string& warning : compile(spec).warnings)
      if (warning.find("loses its stability") != std::string::npos) return true;
    return false;
  };
  ElasticSpec ogden;
  ogden.law = Law::ogden;
  ogden.poisson_ratio = 0.45;
  ogden.ogden = {{0.5, 2}, {-0.1, -3}};
  EXPECT_FALSE(warns(ogden));
  ogden.ogden = {{0.5, 2}, {0.25, -3}};  // gains by being pressed
  EXPECT_TRUE(warns(ogden));
  ElasticSpec rivlin;
  rivlin.law = Law::mooney_rivlin;
  rivlin.poisson_ratio = 0.45;
  rivlin.c10 = 0.3;
  rivlin.c01 = 0.1;
  EXPECT_FALSE(warns(rivlin));
  rivlin.c10 = 0.5;
  rivlin.c01 = -0.35;
  EXPECT_TRUE(warns(rivlin));
}

TEST(ElasticConstants, Refusals) {
  RobotSpec lame = physical_robot(block_mesh({1, 1, 1}, {1, 1, 1}));
  lame.materials[0].origin = line(3);
  const auto change = [](const std::function<void(ElasticSpec&)>& f) {
    return [=](RobotSpec& spec) { f(*spec.materials[0].elastic); };
  };
  const double nan = std::nan("");
  expect_refused(
      lame,
      {
          {"none", [](RobotSpec& s) { s.materials[0].elastic.reset(); },
           "robot.yaml:3: the material of region 'all' needs elastic constants"},
          {"no E", change([](ElasticSpec& e) { e.youngs_modulus.reset(); }), "needs youngs_modulus"},
          {"no nu", change([](ElasticSpec& e) { e.poisson_ratio.reset(); }), "needs poisson_ratio"},
          {"E 0", change([](ElasticSpec& e) { e.youngs_modulus = 0; }), "youngs_modulus must be above 0, not 0"},
          {"E nan", change([=](ElasticSpec& e) { e.youngs_modulus = nan; }), "youngs_modulus must be finite"},
          {"E inf", change([](ElasticSpec& e) { e.youngs_modulus = INFINITY; }), "youngs_modulus must be finite"},
          {"nu 0.51", change([](ElasticSpec& e) { e.poisson_ratio = 0.51; }),
           "must lie between -1 and 0.5, not be 0.51"},
          {"nu -1", change([](ElasticSpec& e) { e.poisson_ratio = -1; }), "must lie between -1 and 0.5, not be -1"},
          {"nu nan", change([=](ElasticSpec& e) { e.poisson_ratio = nan; }), "poisson_ratio must be finite"},
          {"c10", change([](ElasticSpec& e) { e.c10 = 1; }), "has c10, which its law does not take"},
          {"bulk", change([](ElasticSpec& e) { e.bulk_modulus = 1; }), "has bulk_modulus, which its law"},
          {"shear", change([](ElasticSpec& e) { e.shear_modulus = 1; }), "has shear_modulus, which its law does not"},
          {"jm", change([](ElasticSpec& e) { e.jm = 1; }), "has jm, which its law does not take"},
          {"permittivity", [](RobotSpec& s) { s.materials[0].permittivity = 0.9; },
           "permittivity must be 1 or above, not 0.9"},
          {"permittivity nan", [=](RobotSpec& s) { s.materials[0].permittivity = nan; }, "must be 1 or above"},
          {"density", [](RobotSpec& s) { s.materials[0].density = -1; }, "density must be 0 or above, not -1"},
          {"density nan", [=](RobotSpec& s) { s.materials[0].density = nan; }, "density must be 0 or above"},
      });
  RobotSpec rivlin = lame;
  ElasticSpec& elastic = *rivlin.materials[0].elastic;
  elastic = {};
  elastic.law = Law::mooney_rivlin;
  elastic.c10 = elastic.c01 = 0.1;
  elastic.bulk_modulus = 10;
  expect_refused(rivlin, {
                             {"sum", change([](ElasticSpec& e) { e.c01 = -0.1; }), "c10 + c01 must be above 0, not 0"},
                             {"no c01", change([](ElasticSpec& e) { e.c01.reset(); }), "needs c01"},
                             {"nan", change([=](ElasticSpec& e) { e.c01 = nan; }), "c01 must be finite"},
                             {"c20", change([](ElasticSpec& e) { e.c20 = 1; }), "has c20, which its law"},
                             {"E", change([](ElasticSpec& e) { e.youngs_modulus = 1; }), "has youngs_modulus, which"},
                             {"both", change([](ElasticSpec& e) { e.poisson_ratio = 0.4; }), "one of the two"},
                             {"neither", change([](ElasticSpec& e) { e.bulk_modulus.reset(); }),
                              "needs bulk_modulus or poisson_ratio"},
                             {"bulk", change([](ElasticSpec& e) { e.bulk_modulus = 0; }), "bulk_modulus must be above"},
                             {"yeoh", change([](ElasticSpec& e) { e.law = Law::yeoh; }), "has c01, which its law"},
                         });
  RobotSpec gent = lame;
  ElasticSpec& limited = *gent.materials[0].elastic;
  limited = {};
  limited.law = Law::gent;
  limited.shear_modulus = 0.1;
  limited.jm = 30;
  limited.bulk_modulus = 10;
  expect_refused(
      gent,
      {
          {"no jm", change([](ElasticSpec& e) { e.jm.reset(); }), "needs jm: its law takes it"},
          {"jm", change([](ElasticSpec& e) { e.jm = 0; }), "jm must be above 0, not 0"},
          {"no shear", change([](ElasticSpec& e) { e.shear_modulus.reset(); }), "needs shear_modulus"},
          {"shear", change([](ElasticSpec& e) { e.shear_modulus = -1; }), "shear_modulus must be above 0"},
          {"c10", change([](ElasticSpec& e) { e.c10 = 1; }), "has c10, which its law"},
          {"E", change([](ElasticSpec& e) { e.youngs_modulus = 1; }), "has youngs_modulus, which its law"},
          {"neither", change([](ElasticSpec& e) { e.bulk_modulus.reset(); }), "needs bulk_modulus or poisson_ratio"},
      });
}

TEST(ElasticConstants, TargetShapesDoWithout) {
  RobotSpec spec = block_robot(block_mesh({1, 1, 1}, {1, 1, 1}));
  EXPECT_EQ(refusal(spec), "");
  spec.materials[0].shape_ratio.reset();
  EXPECT_NE(refusal(spec).find("needs shape_ratio"), std::string::npos);
}

}  // namespace
