#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>
#include <variant>

namespace stilt::hal {

/// std::visit for a variant that always holds a value: nothing to throw. Real-time safe.
template <std::size_t i = 0, class Variant, class Function>
constexpr decltype(auto) visit_driver(Variant& any, const Function& function) {
  if constexpr (i + 1 < std::variant_size_v<std::remove_const_t<Variant>>) {
    if (any.index() != i) return visit_driver<i + 1>(any, function);
  }
  return function(*std::get_if<i>(&any));
}

}  // namespace stilt::hal
