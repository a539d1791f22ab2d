"""Materials: how a surface scatters light."""
