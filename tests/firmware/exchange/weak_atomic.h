#pragma once

#include "tests/firmware/exchange/memory_model.h"

namespace stilt::exchange::model {

/// The order that is left of a wanted one when acquire, or release, is forgotten.
constexpr std::memory_order without(std::memory_order forgotten, std::memory_order wanted) {
  if (wanted == forgotten) return std::memory_order_relaxed;
  if (wanted != std::memory_order_acq_rel) return wanted;
  return forgotten == std::memory_order_acquire ? std::memory_order_release : std::memory_order_acquire;
}

/// A ModelAtomic without one of its orders: correct code turned into a wrong variant of itself.
template <class T, std::memory_order kForgotten>
class ForgetfulAtomic : public ModelAtomic<T> {
 public:
  using ModelAtomic<T>::ModelAtomic;
  T load(std::memory_order order) const { return ModelAtomic<T>::load(without(kForgotten, order)); }
  void store(T value, std::memory_order order) { ModelAtomic<T>::store(value, without(kForgotten, order)); }
  T exchange(T value, std::memory_order order) {
    return ModelAtomic<T>::exchange(value, without(kForgotten, order));
  }
};

template <class T>
using WithoutAcquire = ForgetfulAtomic<T, std::memory_order_acquire>;
template <class T>
using WithoutRelease = ForgetfulAtomic<T, std::memory_order_release>;

}  // namespace stilt::exchange::model
