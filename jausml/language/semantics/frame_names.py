"""Names of the `Frame` literals whose axes have directions."""

FLU, FRD = "forwardLeftUp", "forwardRightDown"
ENU, NED = "eastNorthUp", "northEastDown"
UP, DOWN = "localUp", "localDown"
