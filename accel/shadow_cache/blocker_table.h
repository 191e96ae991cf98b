#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "accel/shadow_cache/shadow_cache.h"
#include "core/base/column.h"

namespace raymeter {

/// The entries of a shadow cache: what blocked the last ray of each light, of each light and lit object, or of each light and node of the ray tree. An object
/// is a composite of the scene, or a primitive that stands alone.
class BlockerTable {
public:
  BlockerTable(const Scene& scene, const ShadowCacheParams& params);

  /// Tables of many objects are cleared for every tile of a frame: so entries are not written, but of an age that is past.
  void clear() noexcept {
    if (++age_ == 0) {
      std::fill(entries_.begin(), entries_.end(), Entry{});
      age_ = 1;
    }
  }
  /// The entry of ray i.
  [[nodiscard]] std::size_t entry(const ShadowOrigins& origins, std::size_t i) const noexcept {
    return static_cast<std::size_t>(origins.light[i]) * stride_ + place(origins, i);
  }
  /// A dropped primitive where the entry is empty.
  [[nodiscard]] PrimRef operator[](std::size_t entry) const noexcept { return entries_[entry].age == age_ ? entries_[entry].blocker : kNothing; }
  /// A ray of this entry was blocked by that primitive, or by none (-1).
  void learn(std::size_t entry, std::int32_t blocker) noexcept {
    if (blocker >= 0)
      entries_[entry] = {scene_.prim(blocker), age_};
    else if (forgets_)
      entries_[entry] = {};
  }

private:
  static constexpr PrimRef kNothing{PrimRef::kDropped, 0};
  struct Entry {
    PrimRef blocker = kNothing;
    std::uint32_t age = 0;
  };

  [[nodiscard]] std::size_t place(const ShadowOrigins& origins, std::size_t i) const noexcept {
    if (object_ != nullptr) return static_cast<std::size_t>((*object_)[static_cast<std::size_t>(origins.source[i])]);
    return by_node_ ? static_cast<std::size_t>(origins.node) : 0;
  }

  const Scene& scene_;
  bool by_node_;
  bool forgets_;
  std::shared_ptr<const Column<std::int32_t>> object_;  ///< of each primitive, shared by copies; null where entries do not go by object
  std::size_t stride_;                                  ///< entries of a light
  Column<Entry> entries_;
  std::uint32_t age_ = 1;  ///< what was learnt at other ages is forgotten
};

}  // namespace raymeter
