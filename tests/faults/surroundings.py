"""What users and the system do to a stream."""


if __name__ == "__main__":
    stands.main(sys.modules[__name__])
