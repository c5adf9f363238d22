#include <gtest/gtest.h>

#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/table/tensile_file.hpp>

namespace softkin {
namespace {

TensileCurve parsed(const std::string& text, const TensileLayout& layout = {}) {
  return parse_tensile_file("test.csv", text, layout);
}

void refuses(const std::string& text, const std::string& words, const TensileLayout& layout = {}) {
  try {
    (void)parsed(text, layout);
    ADD_FAILURE() << text;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("test.csv"), std::string::npos) << error.what();
  }
}

/// Nominal stresses of 0.1 MPa per strain, at these strains.
const std::vector<double> made{0.1, 0.2, 0.4, 0.7, 1.1, 1.6};

std::string table(const std::string& header, const std::string& separator, double strain_scale, double stress_scale) {
  std::string text = header + "\n";
  for (const double e : made)
    text +=
        "0" + separator + std::to_string(e * strain_scale) + separator + std::to_string(0.1 * e * stress_scale) + "\n";
  return text;
}

void expect_made(const TensileCurve& curve, const std::string& what) {
  ASSERT_EQ(curve.strain.size(), made.size()) << what;
  for (std::size_t i = 0; i < made.size(); ++i) {
    EXPECT_NEAR(curve.strain[i], made[i], 2e-6) << what;
    EXPECT_NEAR(curve.stress[i], 0.1 * made[i], 2e-6) << what;
  }
}

}  // namespace

TEST(TensileFile, ReadsWhatTestingMachinesWrite) {
  expect_made(parsed(table("Time (s);Engineering Strain;Engineering Stress (MPa)", ";", 1, 1)), "semicolons");
  expect_made(parsed("Operator;Somebody\nStrain Measurement;Global;\n;;\n" +
                     table("Time (s);Strain (%);Stress (kPa)", ";", 100, 1000)),
              "lines before the header");
  expect_made(parsed(table("Time\tTensile strain [mm/mm]\tTensile stress [psi]", "\t", 1, 1 / 0.006894757)), "tabs");
  expect_made(parsed(table("t,strain_percent,stress_kpa", ",", 100, 1000)), "names of softkin with other units");
  TensileLayout specimen;
  specimen.length_mm = 33;
  specimen.area_mm2 = 18;
  expect_made(parsed(table("\"Time (s)\",\"Extension (mm)\",\"Load (N)\"", ",", 33, 18), specimen), "force");
  expect_made(parsed("Time,Extension,Load\n(s),(mm),(N)\n" + table("", ",", 33, 18).substr(1), specimen),
              "row of units");
  TensileLayout named;
  named.strain_column = "a";
  named.stress_column = "b";
  named.strain_unit = "%";
  named.stress_unit = "kPa";
  expect_made(parsed(table("t,a,b", ",", 100, 1000), named), "columns that are named");
}

TEST(TensileFile, ReadsDecimalCommas) {
  std::string text = table("Zeit (s);Strain;Stress (MPa)", ";", 1, 1);
  for (char& c : text)
    if (c == '.') c = ',';
  expect_made(parsed(text), "decimal commas");
}

/// True measures at constant volume, and nominal ones first where a file has both.
TEST(TensileFile, ConvertsTrueMeasures) {
  std::string both = "Time (s);True Strain;True Stress (MPa);Engineering Strain;Engineering Stress (MPa)\n",
              alone = "True Strain;True Stress (MPa)\n";
  for (const double e : made) {
    const std::string part = std::to_string(std::log1p(e)) + ";" + std::to_string(0.1 * e * (1 + e));
    both += "0;" + part + ";" + std::to_string(e) + ";" + std::to_string(0.1 * e) + "\n";
    alone += part + "\n";
  }
  const TensileCurve nominal = parsed(both), converted = parsed(alone);
  expect_made(nominal, "both");
  EXPECT_NE(nominal.notes.at(0).find("Engineering Strain"), std::string::npos);
  ASSERT_EQ(converted.strain.size(), made.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    EXPECT_NEAR(converted.strain[i], made[i], 5e-6);
    EXPECT_NEAR(converted.stress[i], 0.1 * made[i], 2e-6);
  }
  EXPECT_NE(converted.notes.at(0).find("constant volume"), std::string::npos);
}

/// Two cycles to 1 and 2: virgin where it is new, half as stiff where it was before.
TEST(TensileFile, ChoosesTheBranchOfACyclicTest) {
  std::string text = "strain;stress (MPa)\n";
  const auto row = [&](double e, double s) { text += std::to_string(e) + ";" + std::to_string(s) + "\n"; };
  for (int i = 0; i <= 20; ++i) row(0.05 * i, 0.05 * i);
  for (int i = 19; i >= 0; --i) row(0.05 * i, 0.4 * 0.05 * i);
  for (int i = 1; i <= 20; ++i) row(0.05 * i, 0.5 * 0.05 * i);
  for (int i = 21; i <= 40; ++i) row(0.05 * i, 0.05 * i);
  for (int i = 39; i >= 10; --i) row(0.05 * i, 0.4 * 0.05 * i);
  const auto with = [&](TensileBranch branch) {
    TensileLayout layout;
    layout.branch = branch;
    return parsed(text, layout);
  };
  const TensileCurve envelope = with(TensileBranch::envelope), first = with(TensileBranch::first),
                     last = with(TensileBranch::last);
  EXPECT_EQ(envelope.strain.size(), 41u);
  for (std::size_t i = 0; i < envelope.strain.size(); ++i) EXPECT_NEAR(envelope.stress[i], envelope.strain[i], 1e-6);
  EXPECT_NEAR(first.strain.back(), 1, 1e-6);
  EXPECT_EQ(first.strain.size(), 21u);
  EXPECT_NEAR(last.strain.back(), 2, 1e-6);
  EXPECT_NEAR(last.stress[10], 0.5 * last.strain[10], 1e-6);
  EXPECT_NE(envelope.notes.at(1).find("left out"), std::string::npos);
}

TEST(TensileFile, TakesSlackAndPreloadOut) {
  const auto shifted = [](double slack) {
    std::string text = "strain;stress (MPa)\n";
    for (int i = 0; i <= 40; ++i) {
      const double e = 0.02 * i;  // of the length between the grips; the specimen is taut from the slack on
      text += std::to_string(e) + ";" + std::to_string(std::max(0.0, 3 * ((1 + e) / (1 + slack) - 1))) + "\n";
    }
    return text;
  };
  TensileLayout toe;
  toe.zero = TensileZero::toe;
  const TensileCurve preloaded = parsed(shifted(-0.05), toe);  // under load where the file begins
  for (std::size_t i = 0; i < preloaded.strain.size(); ++i)
    EXPECT_NEAR(preloaded.stress[i], 3 * preloaded.strain[i], 1e-4);
  TensileLayout first;
  first.zero = TensileZero::first;
  const TensileCurve zeroed = parsed(shifted(-0.05), first);
  EXPECT_EQ(zeroed.strain[0], 0);
  EXPECT_EQ(zeroed.stress[0], 0);
}

TEST(TensileFile, RefusesWhatIsNotClear) {
  const std::string rows = "0;0\n.1;1\n.2;2\n.3;3\n.4;4\n";
  refuses("a;b\n" + rows, "no line is a header with a strain");
  refuses("Strain;Stress\n" + rows, "has no unit that is known");
  refuses("Strain (furlong);Stress (MPa)\n" + rows, "the option 'strain-unit'");
  refuses("Extension (mm);Stress (MPa)\n" + rows, "the option 'length'");
  refuses("Strain;Load (N)\n" + rows, "the option 'area'");
  refuses("Strain 1;Strain 2;Stress (MPa)\n0;0;0\n", "name one by the option 'strain-column'");
  refuses("Strain;Stress (MPa)\n0;0\n.1;x\n", "test.csv:3: column 'Stress (MPa)' must hold a finite number, not 'x'");
  refuses("Strain;Stress (MPa)\n0;0\n.1;1\n", "at least five rows");
  refuses("Strain;Stress (MPa)\n" + rows + "400;4\n", "is it in percent?");
  refuses("Strain;Stress (MPa)\n0;0\n-.2;-1\n.1;1\n.2;2\n.3;3\n.4;4\n", "not below 0");
  TensileLayout named;
  named.strain_column = "none";
  refuses("Strain;Stress (MPa)\n" + rows, "no line has columns 'none'", named);
}

TEST(TensileFile, TablesOfSoftkinAreNotOfATestingMachine) {
  EXPECT_FALSE(is_machine_file("# made up\nstrain_percent,stress_mpa\n0,0\n"));
  EXPECT_FALSE(is_machine_file("stress_MPa,strain\n0,0\n"));
  EXPECT_FALSE(is_machine_file("x,y\n0,0\n"));
  EXPECT_TRUE(is_machine_file("Time (s);Strain;Stress (MPa)\n0;0;0\n"));
  EXPECT_TRUE(is_machine_file("Operator,Somebody\nStrain (%),Stress (MPa)\n0,0\n"));
}

}  // namespace softkin
