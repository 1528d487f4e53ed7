"""Laws in no list: a small grammar of forms in the slots of the simulator, fitted where structure stays unexplained."""
