#pragma once

#include <cstddef>
#include <cstring>
#include <new>
#include <type_traits>

namespace stilt::testing_support {

/// Fills memory with a byte. 0xFF makes every number NaN; 0x5A makes it 1.8e127, which arithmetic keeps
/// finite.
inline void fill_memory(void* memory, std::size_t bytes, unsigned char value) {
  std::memset(memory, value, bytes);
  asm volatile("" : : "r"(memory) : "memory");  // else the compiler drops it: a constructor follows
}

/// An object in memory that held NaN: what its constructor leaves out is not zero by chance.
template <class Object>
class InUsedMemory {
 public:
  InUsedMemory() {
    static_assert(std::is_trivially_destructible_v<Object>);
    fill_memory(memory_, sizeof memory_, 0xFF);
    object_ = new (memory_) Object;
  }
  InUsedMemory(const InUsedMemory&) = delete;
  InUsedMemory& operator=(const InUsedMemory&) = delete;
  operator Object&() { return *object_; }

 private:
  alignas(Object) std::byte memory_[sizeof(Object)];
  Object* object_;
};

}  // namespace stilt::testing_support
