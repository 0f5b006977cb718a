// The class that pluginlib would load from the library.
#pragma once

#include <memory>

#define PLUGINLIB_EXPORT_CLASS(Class, Base) \
    std::unique_ptr<Base> plugin() { return std::make_unique<Class>(); }
