struct once {
    int x;
};
