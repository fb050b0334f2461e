// Compiles and succeeds where a std::vector can stand on memory that is not its own.
#include "../adopted_vector.hpp"

#include <array>
#include <memory>

namespace
{

struct Message
{
  std::vector<std::uint8_t> data;
  std::unique_ptr<robot_vision::AdoptedVector> adopted;
};

std::array<std::uint8_t, 64> memory;

}  // namespace

int main()
{
  memory.fill(7);
  std::vector<std::uint8_t> copy;
  {
    Message message;
    message.data.assign(100, 1);
    message.adopted = std::make_unique<robot_vision::AdoptedVector>(message.data, memory.data(), memory.size());
    const std::vector<std::uint8_t>& data = message.data;
    if (data.data() != memory.data() || data.size() != memory.size() || data.capacity() != memory.size()) return 1;
    if (data.begin() == data.end() || data.back() != 7) return 2;
    copy = data;
  }
  if (copy.data() == memory.data() || copy.size() != memory.size() || copy[63] != 7) return 3;
  std::vector<std::uint8_t> later;
  {
    const robot_vision::AdoptedVector adopted(later, memory.data(), memory.size());
  }
  if (!later.empty() || later.data() != nullptr || later.capacity() != 0) return 4;
  later.assign(1000, 2);
  return later.size() == 1000 && memory[0] == 7 ? 0 : 5;
}
