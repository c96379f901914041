#pragma once

#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "firmware/configuration/schema.h"

/// How the tables of the schema name a field: by the path of pointers to members that leads to it.
namespace stilt::configuration::fields {

/// The field at the end of a path of pointers to members and indices.
template <auto First, auto... Rest>
constexpr auto& at(auto& parameters) {
  auto& inner = [&]() -> auto& {
    if constexpr (std::is_integral_v<decltype(First)>) {
      return parameters[First];
    } else {
      return parameters.*First;
    }
  }();
  if constexpr (sizeof...(Rest) == 0) {
    return inner;
  } else {
    return at<Rest...>(inner);
  }
}

template <auto... Path>
constexpr RealField real(double min, double max) {
  return {[](const Parameters& p) -> const double& { return at<Path...>(p); },
          [](Parameters& p, double value) { at<Path...>(p) = value; }, min, max};
}

template <auto... Path>
constexpr IntegerField integer(int min, int max) {
  return {[](const Parameters& p) -> const int& { return at<Path...>(p); },
          [](Parameters& p, int value) { at<Path...>(p) = value; }, min, max};
}

template <auto... Path>
constexpr FlagField flag() {
  return {[](const Parameters& p) -> const bool& { return at<Path...>(p); },
          [](Parameters& p, bool value) { at<Path...>(p) = value; }};
}

template <auto... Path>
constexpr ChoiceField choice(std::span<const std::string_view> words) {
  return {[](const Parameters& p) { return static_cast<int>(at<Path...>(p)); },
          [](Parameters& p, int value) {
            auto& field = at<Path...>(p);
            field = static_cast<std::remove_reference_t<decltype(field)>>(value);
          },
          [](const Parameters& p) -> const void* { return &at<Path...>(p); },
          sizeof(at<Path...>(std::declval<Parameters&>())), words};
}

template <auto... Path>
constexpr TextField text(std::string_view form, std::optional<std::string> (*mistake)(const std::string&)) {
  return {[](const Parameters& p) -> const std::string& { return at<Path...>(p); },
          [](Parameters& p, const std::string& value) { at<Path...>(p) = value; }, form, mistake};
}

}  // namespace stilt::configuration::fields
