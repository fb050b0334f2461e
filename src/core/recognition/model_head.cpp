#include "model_head.hpp"

#include <cstdint>

#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

const std::string kMagic = "RVmodel\n";
constexpr std::uint32_t kVersion = 1;

}  // namespace

void writeModelHead(const std::string& method, ByteWriter& to)
{
  to.addText(kMagic);
  to.add(kVersion);
  to.add(static_cast<std::uint8_t>(method.size()));
  to.addText(method);
}

void checkModelHead(const std::string& method, ByteReader& from)
{
  const std::string magic = from.text(kMagic.size());
  require(magic == kMagic, "the beginning of a trained model", "'" + printable(magic) + "'", "that of one");
  const auto version = from.next<std::uint32_t>();
  require(version <= kVersion, "the version of a trained model", version,
          "at most " + std::to_string(kVersion) + ": a newer version of this package has made it");
  require(version == kVersion, "the version of a trained model", version, std::to_string(kVersion));
  const std::string name = from.text(from.next<std::uint8_t>());
  require(name == method, "the method of a trained model", "'" + printable(name) + "'", "'" + method + "'");
}

}  // namespace robot_vision
