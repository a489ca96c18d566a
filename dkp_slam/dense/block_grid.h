#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

namespace dkp_slam {

/// A grid without bounds that takes memory only where something is: blocks of 8 x 8 x 8 cells,
/// found by a hash of their place (Nießner et al., "Real-time 3D Reconstruction at Scale using
/// Voxel Hashing", SIGGRAPH Asia 2013). Blocks keep the order in which they were added.
template <class Cell>
class BlockGrid {
 public:
  static constexpr int side = 8;
  static constexpr int cells = side * side * side;
  using Block = std::array<Cell, cells>;

  explicit BlockGrid(std::size_t most_blocks) : most_(most_blocks) {}

  static Eigen::Vector3i block_of(const Eigen::Vector3i& cell) {
    return {cell.x() >> 3, cell.y() >> 3, cell.z() >> 3};  // rounds down, below 0, too
  }
  static std::size_t index_in_block(const Eigen::Vector3i& cell) {
    return static_cast<std::size_t>((cell.x() & 7) | (cell.y() & 7) << 3 | (cell.z() & 7) << 6);
  }

  /// False when there is no room for one more.
  bool add(const Eigen::Vector3i& block) {
    if (index_.contains(key(block))) return true;
    if (blocks_.size() >= most_) return false;
    index_.emplace(key(block), blocks_.size());
    blocks_.push_back(std::make_unique<Block>());
    places_.push_back(block);
    return true;
  }
  /// Null where there is no such block.
  Block* find(const Eigen::Vector3i& block) {
    const auto found = index_.find(key(block));
    return found == index_.end() ? nullptr : blocks_[found->second].get();
  }
  const Block* find(const Eigen::Vector3i& block) const {
    const auto found = index_.find(key(block));
    return found == index_.end() ? nullptr : blocks_[found->second].get();
  }
  const Cell* cell(const Eigen::Vector3i& at) const {
    const Block* block = find(block_of(at));
    return block ? &(*block)[index_in_block(at)] : nullptr;
  }

  std::size_t size() const { return blocks_.size(); }
  std::size_t most() const { return most_; }
  Block& block(std::size_t i) { return *blocks_[i]; }
  const Block& block(std::size_t i) const { return *blocks_[i]; }
  /// In blocks: its first cell is 8 times that.
  const Eigen::Vector3i& place(std::size_t i) const { return places_[i]; }

 private:
  struct Mix {
    std::size_t operator()(std::uint64_t k) const {
      k *= 0x9E3779B97F4A7C15U;
      return k ^ k >> 29U;
    }
  };
  /// 21 bits an axis: kilometres of millimetres.
  static std::uint64_t key(const Eigen::Vector3i& b) {
    constexpr std::uint64_t mask = (1U << 21U) - 1;
    const auto bits = [](int v) { return static_cast<std::uint64_t>(std::int64_t{v}) & mask; };
    return bits(b.x()) | bits(b.y()) << 21U | bits(b.z()) << 42U;
  }

  std::size_t most_;
  std::unordered_map<std::uint64_t, std::size_t, Mix> index_;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<Eigen::Vector3i> places_;
};

}  // namespace dkp_slam
