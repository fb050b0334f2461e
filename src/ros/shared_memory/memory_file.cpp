#include "memory_file.hpp"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include "shared_memory_error.hpp"

namespace robot_vision
{
namespace
{

// Newer than some C libraries.
constexpr int kSealFutureWrite = 0x10;        // F_SEAL_FUTURE_WRITE
constexpr unsigned kNoExecutableSeal = 0x8U;  // MFD_NOEXEC_SEAL: some systems allow no other

[[noreturn]] void throwSystemError(const std::string& what)
{
  throw SharedMemoryError(SharedMemoryFault::kNoDescriptors, what + ": " + std::strerror(errno));
}

[[noreturn]] void refuse(const std::string& why)
{
  throw SharedMemoryError(SharedMemoryFault::kRefused, "memory of another process is refused: " + why);
}

Descriptor openMemory(const char* name)
{
  int number = memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING | kNoExecutableSeal);
  if (number < 0 && errno == EINVAL) number = memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (number < 0) throwSystemError("no shared memory for images: memfd_create");
  return Descriptor(number);
}

/// Gives the file memory. A signal of the process takes back all that one call has got so far: so it is asked for in
/// parts, of which some come through between signals.
bool allocate(int number, off_t bytes)
{
  constexpr off_t kPart = 1 << 20;  // bytes
  for (off_t begin = 0; begin < bytes; begin += kPart)
    while (fallocate(number, 0, begin, std::min(kPart, bytes - begin)) != 0)
      if (errno != EINTR) return false;
  return true;
}

Mapping map(const Descriptor& descriptor, std::size_t bytes, int protection)
{
  void* memory = mmap(nullptr, bytes, protection, MAP_SHARED | MAP_POPULATE, descriptor.get(), 0);
  if (memory == MAP_FAILED) throwSystemError("shared memory of " + std::to_string(bytes) + " bytes is not mapped");
  return {static_cast<std::uint8_t*>(memory), bytes};
}

}  // namespace

Mapping::~Mapping()
{
  if (data_ != nullptr) munmap(data_, bytes_);
}

WriteProtection writeProtection()
{
  static const WriteProtection found = []
  {
    const Descriptor tried = openMemory("robot_vision probe");
    const bool sealed = fcntl(tried.get(), F_ADD_SEALS, kSealFutureWrite) == 0;
    return sealed ? WriteProtection::kSeal : WriteProtection::kReadOnlyDescriptor;
  }();
  return found;
}

MemoryFile makeMemoryFile(const char* name, std::size_t bytes, WriteProtection protection)
{
  if (bytes > kMaxMemoryFile)
    throw SharedMemoryError(SharedMemoryFault::kRefused, "no shared memory of " + std::to_string(bytes) +
                                                             " bytes: the limit is " + std::to_string(kMaxMemoryFile));
  MemoryFile made{openMemory(name), {}};
  const int number = made.descriptor.get();
  const auto size = static_cast<off_t>(bytes);
  if (ftruncate(number, size) != 0 || !allocate(number, size))
    throwSystemError("no shared memory of " + std::to_string(bytes) + " bytes");
  made.mapping = map(made.descriptor, bytes, PROT_READ | PROT_WRITE);
  const int seals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;
  if (fcntl(number, F_ADD_SEALS, protection == WriteProtection::kSeal ? seals | kSealFutureWrite : seals) != 0)
    throwSystemError("shared memory is not sealed");
  if (protection == WriteProtection::kSeal) return made;
  Descriptor for_reading(open(("/proc/self/fd/" + std::to_string(number)).c_str(), O_RDONLY | O_CLOEXEC));
  if (!for_reading) throwSystemError("shared memory cannot be opened for reading only");
  made.descriptor = std::move(for_reading);
  return made;
}

Mapping mapForeignMemory(const Descriptor& descriptor, std::size_t min_bytes, std::size_t max_bytes)
{
  const int seals = fcntl(descriptor.get(), F_GET_SEALS);
  struct stat info;
  struct statfs file_system;
  if (seals < 0 || fstat(descriptor.get(), &info) != 0 || fstatfs(descriptor.get(), &file_system) != 0)
    refuse("it is no memfd");
  if (file_system.f_type != TMPFS_MAGIC) refuse("it is no memfd of ordinary pages");
  if ((seals & F_SEAL_SHRINK) == 0) refuse("it can be truncated");
  if (writeProtection() == WriteProtection::kSeal && (seals & (kSealFutureWrite | F_SEAL_WRITE)) == 0)
    refuse("its pages can be taken away");
  const auto size = static_cast<std::size_t>(info.st_size);
  if (size < min_bytes || size > max_bytes)
    refuse("it has " + std::to_string(size) + " bytes and must have " + std::to_string(min_bytes) + " to " +
           std::to_string(max_bytes));
  if (info.st_blocks * 512 < info.st_size) refuse("it has holes");
  return map(descriptor, size, PROT_READ);
}

}  // namespace robot_vision
