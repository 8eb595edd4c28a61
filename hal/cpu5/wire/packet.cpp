#include "hal/cpu5/wire/packet.h"

#include "hal/cpu5/wire/crc32.h"

namespace cnc::hal::cpu5::wire {
namespace {

std::span<std::uint8_t> packet_memory(std::span<std::uint8_t> memory) {
  return memory.first(memory.size() < kMaxPacket ? memory.size() : kMaxPacket);
}

}  // namespace

PacketWriter::PacketWriter(std::span<std::uint8_t> memory, PacketType type, std::uint32_t session)
    : memory_(packet_memory(memory)), body_(memory_.first(memory_.size() - kCrcSize)) {
  body_.put(kMagic);
  body_.put(kVersion);
  body_.put(static_cast<std::uint8_t>(type));
  body_.put(session);
}

std::span<const std::uint8_t> PacketWriter::finish() {
  if (body_.overflow()) return {};
  const std::size_t size = body_.size();
  ByteWriter end(memory_.subspan(size, kCrcSize));
  end.put(crc32(body_.written()));
  return memory_.first(size + kCrcSize);
}

std::optional<ReceivedPacket> open_packet(std::span<const std::uint8_t> packet) {
  if (packet.size() < kHeaderSize + kCrcSize || packet.size() > kMaxPacket) return std::nullopt;
  const auto content = packet.first(packet.size() - kCrcSize);
  ByteReader end(packet.last(kCrcSize));
  if (end.get<std::uint32_t>() != crc32(content)) return std::nullopt;
  ByteReader reader(content);
  if (reader.get<std::uint16_t>() != kMagic) return std::nullopt;
  ReceivedPacket result;
  result.header.version = reader.get<std::uint8_t>();
  result.header.type = static_cast<PacketType>(reader.get<std::uint8_t>());
  result.header.session = reader.get<std::uint32_t>();
  result.body = reader;
  return result;
}

}  // namespace cnc::hal::cpu5::wire
