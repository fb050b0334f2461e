#pragma once

#include <cstddef>

namespace robot_vision
{

/// True if the bytes are a JPEG stream from its start-of-image to its end-of-image marker (ITU-T T.81, annex B).
/// Decoders fill the missing part of a truncated stream with grey instead of failing, so this has to be asked first.
bool isCompleteJpeg(const unsigned char* data, std::size_t size);

}  // namespace robot_vision
