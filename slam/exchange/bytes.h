#pragma once
// The bytes of the exchange: platform/base/bytes.h.

#include "platform/base/bytes.h"

namespace zenith::exchange {

using zenith::ByteReader;
using zenith::Bytes;
using zenith::ByteWriter;

}  // namespace zenith::exchange
