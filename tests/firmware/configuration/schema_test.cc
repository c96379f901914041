#include "firmware/configuration/schema.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <string>
#include <vector>

namespace stilt::configuration {
namespace {

struct Bytes {
  std::size_t begin;
  std::size_t size;
  std::string name;
};

/// Where an entry's field lies within the parameters.
Bytes bytes_of(const Entry& entry, const Parameters& parameters) {
  const void* address = nullptr;
  std::size_t size = 0;
  if (const auto* real = std::get_if<RealField>(&entry.field)) {
    address = &real->get(parameters);
    size = sizeof(double);
  } else if (const auto* integer = std::get_if<IntegerField>(&entry.field)) {
    address = &integer->get(parameters);
    size = sizeof(int);
  } else if (const auto* flag = std::get_if<FlagField>(&entry.field)) {
    address = &flag->get(parameters);
    size = sizeof(bool);
  } else if (const auto* choice = std::get_if<ChoiceField>(&entry.field)) {
    address = choice->address(parameters);
    size = choice->size;
  } else {
    address = &std::get<TextField>(entry.field).get(parameters);
    size = sizeof(std::string);
  }
  const auto* begin = reinterpret_cast<const char*>(&parameters);
  return {static_cast<std::size_t>(static_cast<const char*>(address) - begin), size, entry.name()};
}

std::vector<Bytes> layout(const Parameters& parameters) {
  std::vector<Bytes> fields;
  for (const Entry& entry : entries()) fields.push_back(bytes_of(entry, parameters));
  // No key of its own: stiltd copies robot.torque_limit_scale.
  const auto begin = reinterpret_cast<const char*>(&parameters);
  const auto copied = reinterpret_cast<const char*>(&parameters.supervisor.plan_torque_share);
  fields.push_back(
      {static_cast<std::size_t>(copied - begin), sizeof(double), "supervisor.plan_torque_share"});
  std::ranges::sort(fields, {}, &Bytes::begin);
  return fields;
}

TEST(Schema, EveryFieldOfTheParametersHasARow) {
  const Parameters parameters;
  std::size_t end = 0;
  for (const Bytes& field : layout(parameters)) {
    // Only padding may lie between two fields: less than what aligns the later one. Sections start at 8.
    const std::size_t gap = field.begin - end;
    EXPECT_LT(gap, alignof(double)) << "a field before " << field.name << " has no row in schema.cc";
    end = field.begin + field.size;
  }
  EXPECT_LT(sizeof(Parameters) - end, alignof(double)) << "the last field has no row in schema.cc";
}

TEST(Schema, NoTwoRowsSetTheSameField) {
  const Parameters parameters;
  const std::vector<Bytes> fields = layout(parameters);
  for (std::size_t i = 1; i < fields.size(); ++i) {
    EXPECT_GE(fields[i].begin, fields[i - 1].begin + fields[i - 1].size)
        << fields[i - 1].name << " and " << fields[i].name;
  }
}

TEST(Schema, NamesAreUniqueAndTheirSectionsKnown) {
  std::set<std::string> names;
  for (const Entry& entry : entries()) {
    EXPECT_TRUE(names.insert(entry.name()).second) << entry.name();
    EXPECT_TRUE(std::ranges::any_of(sections(), [&](const Section& s) { return s.name == entry.section; }))
        << entry.name();
    EXPECT_EQ(find_entry(entry.section, entry.key), &entry);
  }
}

TEST(Schema, EveryRowIsDocumented) {
  for (const Entry& entry : entries()) {
    EXPECT_GE(entry.description.size(), 5u) << entry.name();
    EXPECT_FALSE(entry.description.ends_with('.')) << entry.name();
    const bool number = entry.field.index() <= 1;
    EXPECT_EQ(entry.unit.empty(), !number) << entry.name();
    EXPECT_NE(describe(entry).find("default"), std::string::npos) << entry.name();
  }
}

TEST(Schema, DefaultsLieWithinTheirRanges) {
  const Parameters defaults;
  for (const Entry& entry : entries()) {
    if (const auto* real = std::get_if<RealField>(&entry.field)) {
      EXPECT_GE(real->get(defaults), real->min) << entry.name();
      EXPECT_LE(real->get(defaults), real->max) << entry.name();
    } else if (const auto* integer = std::get_if<IntegerField>(&entry.field)) {
      EXPECT_GE(integer->get(defaults), integer->min) << entry.name();
      EXPECT_LE(integer->get(defaults), integer->max) << entry.name();
    }
  }
}

TEST(Schema, EndsOfARangeAreAcceptedAndWhatLiesBeyondIsNot) {
  for (const Entry& entry : entries()) {
    Parameters parameters;
    if (const auto* real = std::get_if<RealField>(&entry.field)) {
      for (const double end : {real->min, real->max}) {
        EXPECT_EQ(assign(entry, end, parameters), std::nullopt) << entry.name();
        EXPECT_EQ(real->get(parameters), end) << entry.name();
      }
      const double infinity = std::numeric_limits<double>::infinity();
      for (const double wrong : {std::nextafter(real->min, -infinity), std::nextafter(real->max, infinity),
                                 infinity, -infinity, std::nan("")}) {
        EXPECT_TRUE(assign(entry, wrong, parameters)) << entry.name() << " took " << wrong;
        EXPECT_EQ(real->get(parameters), real->max) << "a refused value changed " << entry.name();
      }
    } else if (const auto* integer = std::get_if<IntegerField>(&entry.field)) {
      for (const long long wrong : {integer->min - 1LL, integer->max + 1LL, 1LL << 40}) {
        EXPECT_TRUE(assign(entry, wrong, parameters)) << entry.name();
      }
      EXPECT_EQ(assign(entry, static_cast<long long>(integer->max), parameters), std::nullopt);
      EXPECT_EQ(integer->get(parameters), integer->max);
    }
  }
}

TEST(Schema, EveryWordSetsItsEnumerator) {
  Parameters parameters;
  EXPECT_EQ(assign(*find_entry("discretisation", "integrator"), std::string("rk4"), parameters),
            std::nullopt);
  EXPECT_EQ(parameters.discretisation.integrator, ocp::Integrator::rk4);
  EXPECT_EQ(assign(*find_entry("discretisation", "integrator"), std::string("rk2"), parameters),
            std::nullopt);
  EXPECT_EQ(parameters.discretisation.integrator, ocp::Integrator::rk2);
  EXPECT_EQ(assign(*find_entry("discretisation", "transition"), std::string("impact"), parameters),
            std::nullopt);
  EXPECT_EQ(parameters.discretisation.transition, ocp::Transition::impact);
  EXPECT_EQ(assign(*find_entry("discretisation", "transition"), std::string("identity"), parameters),
            std::nullopt);
  EXPECT_EQ(parameters.discretisation.transition, ocp::Transition::identity);
}

TEST(Schema, NumbersReadBackTheSame) {
  for (const double number : {0.1, 1e-6, 1e12, -0.2, 1.0 / 3.0, 5e-324, 1.7976931348623157e308, 100.0, 0.0}) {
    EXPECT_EQ(std::strtod(number_text(number).c_str(), nullptr), number) << number_text(number);
  }
  EXPECT_EQ(number_text(1e-6), "1e-6");
  EXPECT_EQ(number_text(1e12), "1e12");
}

TEST(Schema, NearestFindsAMisspeltNameAndNothingFarAway) {
  const std::string_view names[] = {"swing_height_m", "single_support_s"};
  EXPECT_EQ(nearest("swing_heigth_m", names), "swing_height_m");
  EXPECT_EQ(nearest("banana", names), "");
}

}  // namespace
}  // namespace stilt::configuration
