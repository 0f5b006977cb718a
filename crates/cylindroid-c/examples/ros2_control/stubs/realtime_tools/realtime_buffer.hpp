#pragma once

#include <mutex>

namespace realtime_tools {
template <class T>
class RealtimeBuffer {
   public:
    void writeFromNonRT(const T &value) {
        std::lock_guard<std::mutex> lock(mutex_);
        value_ = value;
    }
    T *readFromRT() { return &value_; }

   private:
    std::mutex mutex_;
    T value_{};
};
}  // namespace realtime_tools
