// Visits a variant with one lambda per alternative.
#pragma once

namespace cnc::server {

template <class... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};

}  // namespace cnc::server
