// The services of the fake server: the ones that show, the ones that command, and the jog stream,
// each in its own file.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "tests/api/fake_server.h"

namespace cnc::test {

/// gRPC's synchronous services tell a cancellation only to those who ask.
inline constexpr std::chrono::milliseconds kAskAgain{5};

/// Remembers the call; the answer that the test wants for calls of this name.
[[nodiscard]] grpc::Status note_call(FakeMachine& machine, const std::string& name,
                                     const std::string& arguments = "");

using FakeService = std::unique_ptr<grpc::Service>;

[[nodiscard]] FakeService make_fake_system_service(FakeMachine& machine);
[[nodiscard]] FakeService make_fake_status_service(FakeMachine& machine);
[[nodiscard]] FakeService make_fake_messages_service(FakeMachine& machine);
[[nodiscard]] FakeService make_fake_motion_service(FakeMachine& machine);
[[nodiscard]] FakeService make_fake_homing_service(FakeMachine& machine);
[[nodiscard]] FakeService make_fake_mdi_service(FakeMachine& machine);
[[nodiscard]] FakeService make_fake_job_service(FakeMachine& machine);
[[nodiscard]] FakeService make_fake_jog_service(FakeMachine& machine);

}  // namespace cnc::test
