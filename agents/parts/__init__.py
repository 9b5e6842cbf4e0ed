"""What agents are put together from: navigators, localizers, manipulators and answerers, each behind a small interface."""
